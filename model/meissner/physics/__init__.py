"""Physics: what the sensor, the object and the converter do. Float, seeded, never bit-exact."""
