"""Trained forests in the core's integers: from scikit-learn and ONNX to F.json (docs/forest.md)."""
