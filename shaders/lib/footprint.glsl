// The area that one direction of many stands for on the surface that it hits [Colbert and Krivanek 2007]. It
// is legal as GLSL and as C++.

// Returns the area of the widest square that one of N directions of density cos / pi covers [m^2]. Each has
// pi / N of the disc of projected directions: a square s wide, s = sqrt(pi / N). On the sphere that is s by s
// / cos_r, for the disc is foreshortened along one direction only, and on a surface at distance d it is d s
// by d s / (cos_r cos_h) where both tilts fall together. The whole, d^2 pi / (N cos_r cos_h), is long and
// narrow near the horizons; a square of that area would take in what lies beside it, so it is as wide as the
// narrow side: d^2 pi / N.
FUNCTION float footprintArea(vec3 receiver, vec3 hit, uint samples) {
    vec3 d = hit - receiver;
    return dot(d, d) * 3.14159265f / float(int(samples));
}
