// Returns the variance of the mean of the replicates, added over R, G and B.
float spread(vec3 v[kReplicates]) {
    vec3 mean = 0.25 * (v[0] + v[1] + v[2] + v[3]);
    float sum = 0.0;
    for (uint q = 0u; q < kReplicates; ++q) sum += dot(v[q] - mean, v[q] - mean);
    return sum / float(kReplicates * (kReplicates - 1u));
}
