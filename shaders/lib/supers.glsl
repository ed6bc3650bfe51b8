// Super-blocks by address.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer SuperBlocks { SuperBlock items[]; };

SuperBlock loadSuper(ADDRESS supers, uint index) { return SuperBlocks(supers).items[index]; }
