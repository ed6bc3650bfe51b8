// Compiles volk's own code: the Vulkan loader is opened at run time, so that the executable starts without
// one.
#define VOLK_IMPLEMENTATION
#include <volk.h>
