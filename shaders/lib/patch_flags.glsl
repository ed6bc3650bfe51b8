// What Patch::flags say together. Legal as GLSL and as C++ (namespace relume::shader); after shared.h.

// Its light is in the picture, and so counts when errors are told.
FUNCTION bool patchIsShown(uint flags) { return (flags & (kPatchSends | kPatchBackSide | kPatchThin)) == kPatchSends; }
