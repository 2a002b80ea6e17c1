"""Models of the converters, written from their data sheets: they answer like the part and check its timing."""
