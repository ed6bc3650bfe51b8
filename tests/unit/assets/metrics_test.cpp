#include "assets/images/metrics.h"

#include "assets/base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace relume {
namespace {

FloatImage flat(uint32_t width, uint32_t height, float value) {
    FloatImage image{width, height, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        image.add(channel).assign(size_t(width) * height, value);
    return image;
}

std::string errorOf(const FloatImage& a, const FloatImage& b) {
    try {
        compareImages(a, "a.exr", b, "b.exr");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Metrics, AreZeroForEqualImages) {
    for (float value : {0.0f, 0.7f, 30.0f}) {
        const Metrics m = compareImages(flat(3, 2, value), "a", flat(3, 2, value), "b");
        EXPECT_EQ(m.relRmse, 0);
        EXPECT_EQ(m.rmse, 0);
        EXPECT_EQ(m.dfpr, 0);
        EXPECT_EQ(m.maximum, 0);
        EXPECT_EQ(m.bias, 0);
        EXPECT_EQ(m.texels, 6u);
        EXPECT_NEAR(m.meanA, value, 1e-12);
    }
}

TEST(Metrics, FollowTheirDefinitions) {
    FloatImage a = flat(2, 1, 0.5f), b = flat(2, 1, 0.5f);
    a.planes[0] = {1.0f, 0.0f}; // R differs by +0.5, -0.5
    a.planes[1] = {0.5f, 1.5f}; // G by 0, +1
    const Metrics m = compareImages(a, "a", b, "b");
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt((0.25 + 0.25 + 1.0) / 6));
    EXPECT_DOUBLE_EQ(m.relRmse, m.rmse / 0.5);
    EXPECT_DOUBLE_EQ(m.bias, 1.0 / 6);
    EXPECT_DOUBLE_EQ(m.maximum, 1.0);
    EXPECT_DOUBLE_EQ(m.meanA, 4.0 / 6);
    EXPECT_DOUBLE_EQ(m.meanB, 0.5);
    const double half = 1.055 * std::pow(0.5, 1 / 2.4) - 0.055; // 0.5 as displayed; 1.5 shows as 1
    EXPECT_NEAR(m.dfpr, ((1 - half) + std::hypot(half, 1 - half)) / 2, 1e-12);
}

TEST(Metrics, IgnoreWhatOnlyDisplaysCannotTell) {
    const Metrics m = compareImages(flat(1, 1, 3.0f), "a", flat(1, 1, 2.0f), "b");
    EXPECT_EQ(m.dfpr, 0); // both are shown as white
    EXPECT_DOUBLE_EQ(m.rmse, 1);
    EXPECT_DOUBLE_EQ(m.relRmse, 0.5);
}

TEST(Metrics, CountTexelsCoveredInBothOnly) {
    FloatImage a = flat(5, 1, 1.0f), b = flat(5, 1, 1.0f);
    a.planes[0] = {2.0f, 100.0f, std::nanf(""), 50.0f, 1.0f};
    a.add("coverage") = {1.0f, 0.5f, 0.0f, 1.0f, 1.0f};
    b.add("coverage") = {1.0f, 1.0f, 1.0f, 0.5f, 1.0f};
    const Metrics m = compareImages(a, "a", b, "b");
    EXPECT_EQ(m.texels, 2u);
    EXPECT_EQ(m.onlyA, 1u);
    EXPECT_EQ(m.onlyB, 2u);
    EXPECT_DOUBLE_EQ(m.maximum, 1);
    EXPECT_DOUBLE_EQ(m.bias, 1.0 / 6);
    // Without the channel all of b counts.
    EXPECT_EQ(compareImages(a, "a", flat(5, 1, 1.0f), "b").texels, 3u);
}

TEST(Metrics, HaveAnAnswerToABlackReference) {
    const Metrics m = compareImages(flat(2, 2, 1.0f), "a", flat(2, 2, 0.0f), "b");
    EXPECT_TRUE(std::isinf(m.relRmse));
    EXPECT_DOUBLE_EQ(m.rmse, 1);
}

TEST(Metrics, RefuseWhatCannotBeCompared) {
    EXPECT_EQ(errorOf(flat(4, 3, 1), flat(3, 4, 1)),
              "a.exr is 4 x 3, b.exr is 3 x 4: compare images of one size");
    FloatImage grey{2, 2, {}, {}, {}};
    grey.add("Y");
    EXPECT_NE(errorOf(flat(2, 2, 1), grey).find("b.exr: has no channel R"), std::string::npos);
    FloatImage bad = flat(3, 2, 1);
    bad.planes[2][4] = std::nanf("");
    bad.planes[0][5] = std::numeric_limits<float>::infinity();
    EXPECT_NE(errorOf(flat(3, 2, 1), bad)
                  .find("b.exr: 2 covered texels are NaN or infinite, the first at column 1, row 1"),
              std::string::npos);
    EXPECT_NE(errorOf(bad, flat(3, 2, 1)).find("a.exr: 2 covered"), std::string::npos);
    FloatImage empty = flat(2, 2, 1);
    empty.add("coverage");
    EXPECT_NE(errorOf(empty, flat(2, 2, 1)).find("no texel is covered in both"), std::string::npos);
}

TEST(Metrics, CountWhatTheMaskLetsThrough) {
    FloatImage a = flat(4, 1, 1.0f), b = flat(4, 1, 1.0f), mask = flat(4, 1, 0.0f);
    a.planes[0] = {2.0f, 3.0f, std::nanf(""), 100.0f};
    mask.planes[0] = {1.0f, 0.51f, 0.5f, 0.0f}; // R alone decides
    mask.planes[1] = {0.0f, 0.0f, 1.0f, 1.0f};
    const NamedImage named{mask, "mask.png"};
    const Metrics m = ImagePair({a, "a"}, {b, "b"}, &named).measure();
    EXPECT_EQ(m.texels, 2u);
    EXPECT_EQ(m.masked, 2u);
    EXPECT_DOUBLE_EQ(m.maximum, 2);
    mask.add("coverage") = {0.0f, 0.5f, 0.0f, 1.0f}; // goes before R: a lightmap can be a mask
    EXPECT_EQ(ImagePair({a, "a"}, {b, "b"}, &named).measure().maximum, 99);

    const auto errorWith = [&](const FloatImage& image) -> std::string {
        const NamedImage bad{image, "mask.png"};
        try {
            ImagePair({b, "a.exr"}, {b, "b.exr"}, &bad);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(errorWith(flat(4, 2, 1)), "mask.png is 4 x 2, a.exr is 4 x 1: use a mask of the images' size");
    EXPECT_NE(errorWith(flat(4, 1, 0.5f)).find("mask.png: lets no covered texel through"), std::string::npos);
}

TEST(Metrics, MapTheDifferencesOfEachTexel) {
    FloatImage a = flat(3, 1, 0.5f), b = flat(3, 1, 0.5f);
    a.planes[0] = {0.8f, 0.5f, std::nanf("")};
    a.planes[1] = {0.9f, 0.5f, 0.5f};
    a.add("coverage") = {1.0f, 1.0f, 0.0f};
    const ImagePair pair({a, "a"}, {b, "b"});
    const std::vector<float> map = pair.differences();
    EXPECT_NEAR(map[0], 0.5 / std::sqrt(3.0), 1e-6);
    EXPECT_EQ(map[1], 0.0f);
    EXPECT_EQ(map[2], 0.0f);
    EXPECT_NEAR(pair.mean(map), 0.25 / std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(pair.mean(pair.displayedDifferences()), pair.measure().dfpr, 1e-6);
    const std::vector<float> seen = pair.flipDifferences(67.0);
    EXPECT_GT(seen[0], 0.01f);
    EXPECT_EQ(seen[2], 0.0f);
}

TEST(NearestRank, IsAlwaysOneOfTheValues) {
    const std::vector<float> four = {4, 1, 3, 2};
    EXPECT_EQ(nearestRank(four, 0.5), 2);
    EXPECT_EQ(nearestRank(four, 0.51), 3);
    EXPECT_EQ(nearestRank(four, 0), 1);
    EXPECT_EQ(nearestRank(four, 1), 4);
    std::vector<float> twenty;
    for (int i = 20; i > 0; --i)
        twenty.push_back(static_cast<float>(i));
    EXPECT_EQ(nearestRank(twenty, 0.95), 19);
    EXPECT_EQ(nearestRank(twenty, 0.99), 20);
    EXPECT_EQ(nearestRank({}, 0.5), 0);
}

TEST(LocalError, IsRelativeToTheTexelsOwnLightDownToAShareOfTheMedian) {
    FloatImage a = flat(4, 1, 0.0f), b = flat(4, 1, 0.0f);
    for (size_t c = 0; c < 3; ++c)
        b.planes[c] = {10.0f, 2.0f, 0.2f, 0.01f}; // the median is 0.2, and 5 % of it 0.01
    a.planes[0] = {13.0f, 2.0f, 0.2f, 0.01f};     // +1 in the mean of the channels
    a.planes[1] = {10.0f, 2.6f, 0.2f, 0.01f};     // +0.2
    a.planes[2] = {10.0f, 2.0f, 0.26f, 0.04f};    // +0.02, +0.01
    const ImagePair pair({a, "a"}, {b, "b"});
    const std::vector<float> map = pair.localErrors();
    for (size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(map[i], 0.1, 1e-6) << i;
    EXPECT_NEAR(map[3], 1.0, 1e-5);
    b.planes[0][3] = b.planes[1][3] = b.planes[2][3] = 0.005f; // darker than that share
    a.planes[0][3] = a.planes[1][3] = a.planes[2][3] = 0.004f;
    EXPECT_NEAR(pair.localErrors()[3], 0.1, 1e-5);
    const LocalPercentiles local = pair.percentiles(map);
    EXPECT_NEAR(local.p50, 0.1, 1e-6);
    EXPECT_NEAR(local.p90, 1.0, 1e-5);
    EXPECT_NEAR(local.p95, 1.0, 1e-5);
    EXPECT_NEAR(local.p99, 1.0, 1e-5);
}

TEST(LocalError, HasAMedianThatNoMaskChanges) {
    FloatImage a = flat(4, 1, 1.0f), b = flat(4, 1, 1.0f), mask = flat(4, 1, 1.0f);
    for (size_t c = 0; c < 3; ++c) {
        a.planes[c] = {0.02f, 1.0f, 1.0f, 1.0f};
        b.planes[c] = {0.01f, 1.0f, 1.0f, std::nanf("")};
    }
    mask.planes[0] = {1.0f, 0.0f, 0.0f, 0.0f}; // hides all that is bright, and what is not finite
    const NamedImage named{mask, "mask.png"};
    const ImagePair pair({a, "a"}, {b, "b"}, &named);
    EXPECT_NEAR(pair.localErrors()[0], 0.01 / 0.05, 1e-5);
    EXPECT_EQ(pair.localErrors()[1], 0.0f);
    EXPECT_NEAR(pair.percentiles(pair.localErrors()).p95, 0.2, 1e-5);
}

TEST(LocalError, HasAnAnswerToABlackReference) {
    FloatImage a = flat(3, 1, 0.0f), b = flat(3, 1, 0.0f);
    a.planes[0][1] = 1.0f;
    a.planes[0][2] = 3.0f;
    b.planes[0][2] = 2.0f; // the median is 0 all the same
    const ImagePair pair({a, "a"}, {b, "b"});
    const std::vector<float> map = pair.localErrors();
    EXPECT_EQ(map[0], 0.0f);
    EXPECT_TRUE(std::isinf(map[1]));
    EXPECT_NEAR(map[2], 0.5, 1e-6);
    EXPECT_NEAR(pair.percentiles(map).p50, 0.5, 1e-6);
    EXPECT_TRUE(std::isinf(pair.percentiles(map).p95));
}

} // namespace
} // namespace relume
