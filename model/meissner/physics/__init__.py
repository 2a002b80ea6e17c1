"""Physics of the sensor, the object and the converter: floating point, seeded, never bit-exact."""
