"""Models of the converters, from their data sheets: they answer like the part and check the master's
timing."""
