// Reads the picture as it was drawn, with SAMPLES samples in each pixel.

#if SAMPLES > 0
layout(binding = 0) uniform sampler2DMS picture;
ivec2 pictureSize() { return textureSize(picture); }
vec4 fetchSample(ivec2 pixel, int index) { return texelFetch(picture, pixel, index); }
#else
layout(binding = 0) uniform sampler2D picture;
ivec2 pictureSize() { return textureSize(picture, 0); }
vec4 fetchSample(ivec2 pixel, int index) { return texelFetch(picture, pixel, 0); }
#endif
