// This tells what Patch::flags say together. It is legal as GLSL and as C++ (namespace relume::shader); it
// comes after shared.h.

// Returns the patch's texel, row * size + column.
FUNCTION uint patchTexel(uint flags) { return flags >> kTexelShift; }

// Tells whether the patch's light is in the picture, and so counts when errors are told.
FUNCTION bool patchIsShown(uint flags) { return (flags & (kPatchSends | kPatchBackSide | kPatchThin)) == kPatchSends; }
