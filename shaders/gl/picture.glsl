// The picture of the scene before tone mapping, with SAMPLES samples in each pixel.

#if SAMPLES > 0
layout(binding = 0) uniform sampler2DMS picture;
ivec2 pictureSize() { return textureSize(picture); }
vec4 fetchSample(ivec2 pixel, int index) { return texelFetch(picture, pixel, index); }
const int kSamples = SAMPLES;
#else
layout(binding = 0) uniform sampler2D picture;
ivec2 pictureSize() { return textureSize(picture, 0); }
vec4 fetchSample(ivec2 pixel, int index) { return texelFetch(picture, pixel, 0); }
const int kSamples = 1;
#endif
