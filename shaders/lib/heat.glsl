// A scale from black over blue, red and yellow to white. It is legal as GLSL and as C++ (namespace
// relume::shader).

// Returns a colour on a helix around the grey diagonal of the RGB cube, its deviation scaled by t (1 - t) / 2
// [Green 2011: A colour scheme for the display of astronomical intensity images, equation 2]: brightness
// grows evenly, also in print. t in [0, 1], as displayed.
FUNCTION vec3 heatColor(float t) {
    const float start = 0.5f, rotations = -1.1f, hue = 1.2f; // begins blue, ends yellow; colourful
    float angle = 6.2831853f * (start / 3.0f + 1.0f + rotations * t);
    float amplitude = hue * t * (1.0f - t) / 2.0f;
    float c = amplitude * cos(angle), s = amplitude * sin(angle);
    return clamp(vec3(t - 0.14861f * c + 1.78277f * s, t - 0.29227f * c - 0.90649f * s, t + 1.97294f * c), 0.0f, 1.0f);
}
