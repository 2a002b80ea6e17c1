"""What runs beside the core, on the host it is wired to."""
