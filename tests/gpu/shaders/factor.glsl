#ifndef FACTOR
#define FACTOR 1u
#endif
FUNCTION uint scaled(uint x) { return x * FACTOR; }
