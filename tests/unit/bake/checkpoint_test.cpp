// In checkpoint files, what is written is what is read, and nothing else is taken for it.
#include "assets/base/error.h"
#include "bake/output/checkpoint.h"
#include "bake/surface/patches.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/parked_solver.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

namespace relume {
namespace {

using test::ParkedSolver;

class CheckpointFile : public testing::Test {
protected:
    std::string bytes() const {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
    /// Returns what the attempt to go on from the file says; "" when it works.
    std::string problem(const CheckpointKey& key, ParkedSolver& solver) const {
        try {
            Checkpoint(path_, key.version).restore(key, solver);
        } catch (const Error& error) {
            EXPECT_EQ(solver.restores, 0u);
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with(path_ + ": ")) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
            return what.substr(path_.size() + 2);
        }
        return "";
    }
    std::string problem(const CheckpointKey& key) const {
        ParkedSolver solver({16, 5});
        return problem(key, solver);
    }

    const TemporaryFolder folder_;
    const std::string path_ = folder_.path("some.checkpoint");
    const CheckpointKey key_ = {"1.2.3", "size=64 samples=16 smooth=1", 0x0123456789abcdefull};
};

} // namespace

// There are parts of no, of odd and of large size, which are read and written in pieces.
TEST_F(CheckpointFile, HoldsWhatWasSaved) {
    const std::vector<size_t> sizes = {16, 0, 5, (20u << 20) + 3};
    ParkedSolver before(sizes), after(sizes);
    before.fill();
    const uint64_t bytes = saveCheckpoint(path_, key_, before);
    EXPECT_EQ(bytes, std::filesystem::file_size(path_));
    EXPECT_EQ(problem(key_, after), "");
    EXPECT_EQ(after.restores, 1u);
    EXPECT_EQ(after.own.samplePass, 7u);
    EXPECT_EQ(after.own.chunk, 42u);
    EXPECT_TRUE(after.parts == before.parts);
    EXPECT_EQ(after.progress().passes, 3u);
    EXPECT_EQ(after.progress().rays, before.progress().rays);
    EXPECT_EQ(after.progress().passSeconds, before.progress().passSeconds);
    EXPECT_EQ(after.progress().cacheBytes, 0u);
}

// It may be replaced while it is open, as when --checkpoint and --resume name the same file.
TEST_F(CheckpointFile, IsReadAsItWasWhenOpened) {
    ParkedSolver first({16, 5}), second({16, 5}), after({16, 5});
    first.fill();
    saveCheckpoint(path_, key_, first);
    Checkpoint opened(path_, key_.version);
    saveCheckpoint(path_, key_, second);
    opened.restore(key_, after);
    EXPECT_EQ(after.own.samplePass, 7u);
    EXPECT_TRUE(after.parts == first.parts);
}

TEST_F(CheckpointFile, AnyWrongByteIsFound) {
    ParkedSolver solver({16, 5});
    solver.fill();
    saveCheckpoint(path_, key_, solver);
    const std::string whole = bytes();
    ASSERT_GT(whole.size(), 100u);
    for (size_t i = 0; i < whole.size(); ++i) {
        for (const int bit : {0x01, 0x80}) {
            std::string wrong = whole;
            wrong[i] = static_cast<char>(wrong[i] ^ bit);
            write(wrong);
            EXPECT_NE(problem(key_), "") << "byte " << i;
        }
    }
    for (size_t length = 0; length < whole.size(); ++length) {
        write(whole.substr(0, length));
        EXPECT_NE(problem(key_), "") << "of length " << length;
    }
    write(whole + '\0');
    EXPECT_EQ(problem(key_), "is damaged: bake from the start");
    write(whole);
    EXPECT_EQ(problem(key_), "");
}

TEST_F(CheckpointFile, WhatIsNoneIsCalledSo) {
    EXPECT_TRUE(contains(problem(key_), "cannot read: No such file or directory")) << problem(key_);
    write("");
    EXPECT_TRUE(contains(problem(key_), "is empty")) << problem(key_);
    write("v/1\x01 some picture that is long enough to be a checkpoint");
    EXPECT_TRUE(contains(problem(key_), "is no checkpoint")) << problem(key_);
    write("relume checkpoint 1\n and whatever its format was");
    EXPECT_TRUE(contains(problem(key_), "another version")) << problem(key_);
    std::filesystem::remove(path_);
    std::filesystem::create_directory(path_);
    EXPECT_EQ(problem(key_), "is a folder: name a file that --checkpoint wrote");
    std::filesystem::remove(path_);
    ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0); // opening it would wait for its writer
    EXPECT_EQ(problem(key_), "is no regular file: name a file that --checkpoint wrote");
}

TEST_F(CheckpointFile, WhatItsTextsHoldIsToldOnOneLine) {
    ParkedSolver solver({16, 5});
    solver.fill();
    CheckpointKey odd = key_;
    odd.version = "1\n2\r";
    odd.settings = "size=\n1";
    saveCheckpoint(path_, odd, solver);
    EXPECT_TRUE(contains(problem(key_), "was written by Relume 1 2 ")) << problem(key_);
    odd.version = key_.version;
    saveCheckpoint(path_, odd, solver);
    EXPECT_TRUE(contains(problem(key_), "other settings")) << problem(key_);
    EXPECT_EQ(problem(key_).find('\n'), std::string::npos);
}

TEST_F(CheckpointFile, ThatOfAnotherBakeIsRefusedByWhatDiffers) {
    ParkedSolver solver({16, 5});
    solver.fill();
    saveCheckpoint(path_, key_, solver);
    const auto with = [&](const std::function<void(CheckpointKey&)>& change) {
        CheckpointKey other = key_;
        change(other);
        return problem(other);
    };
    const std::string version = with([](CheckpointKey& k) { k.version = "1.2.4"; });
    EXPECT_TRUE(contains(version, "written by Relume 1.2.3, this is 1.2.4")) << version;
    const std::string setting = with([](CheckpointKey& k) { k.settings = "size=64 samples=32 smooth=1"; });
    EXPECT_TRUE(contains(setting, "(samples=16 there, samples=32 here)")) << setting;
    const std::string more = with([](CheckpointKey& k) { k.settings += " window=4"; });
    EXPECT_TRUE(contains(more, "(nothing there, window=4 here)")) << more;
    const std::string scene = with([](CheckpointKey& k) { k.scene ^= 1; });
    EXPECT_TRUE(contains(scene, "another scene")) << scene;
    for (const std::vector<size_t>& sizes : {std::vector<size_t>{16}, {16, 4}, {16, 5, 5}}) {
        ParkedSolver other(sizes);
        EXPECT_TRUE(contains(problem(key_, other), "does not fit"));
    }
}

// A bake that cannot be saved leaves the older checkpoint.
TEST_F(CheckpointFile, AFailureLeavesTheOlderOne) {
    ParkedSolver solver({16, 5});
    solver.fill();
    saveCheckpoint(path_, key_, solver);
    const std::string older = bytes();
    class Broken : public std::exception {};
    class BrokenSolver final : public Solver {
    public:
        void step() override {}
        void setPriority(std::vector<uint8_t>) override {}
        bool passBoundary() const override { return true; }
        void abortPass() override {}
        LiveLight liveLight() override { return {}; }
        const std::vector<glm::vec4>& light() override { return light_; }
        std::vector<float> errors() override { return {}; }
        SolverState state() override { return {}; }
        std::vector<StatePart> stateParts() override {
            return {{4, [](void*, uint64_t, uint64_t) { throw Broken(); }, nullptr}};
        }
        void restore(const SolverState&) override {}

    private:
        std::vector<glm::vec4> light_;
    } broken;
    EXPECT_THROW(saveCheckpoint(path_, key_, broken), Broken);
    EXPECT_EQ(bytes(), older);
    EXPECT_EQ(folder_.files().size(), 1u);
    EXPECT_THROW(saveCheckpoint(folder_.path("nowhere/file"), key_, solver), Error);
}

TEST(SceneFingerprint, KnowsWhatABakeReads) {
    Scene scene;
    scene.materials.resize(1);
    scene.textures.resize(1);
    scene.images.push_back({"image", 1, 1, {1, 2, 3, 4}});
    PatchSet patches;
    patches.scene.patches.resize(64);
    patches.albedo.resize(64);
    patches.emission.resize(64);
    patches.scene.mesh.positions.resize(3);
    patches.scene.texelToPatch.resize(64);
    const uint64_t before = sceneFingerprint(scene, patches);
    EXPECT_EQ(sceneFingerprint(scene, patches), before);
    const std::vector<std::function<void(Scene&, PatchSet&)>> changes = {
        [](Scene&, PatchSet& p) { p.emission[63].r = 1e-30f; },
        [](Scene&, PatchSet& p) { p.albedo[0].b = 0.5f; },
        [](Scene&, PatchSet& p) { p.scene.patches[5].flags ^= shader::kPatchSends; },
        [](Scene&, PatchSet& p) { p.scene.texelToPatch[9] = 1; },
        [](Scene&, PatchSet& p) { p.scene.mesh.positions[2].z = 1.0f; },
        [](Scene& s, PatchSet&) { s.materials[0].emission.g = 2.0f; },
        [](Scene& s, PatchSet&) { s.materials[0].emissionTexture.transform[2][0] = 0.5f; },
        [](Scene& s, PatchSet&) { s.textures[0].nearest = true; },
        [](Scene& s, PatchSet&) { s.images[0].rgba[3] = 5; }};
    for (size_t i = 0; i < changes.size(); ++i) {
        Scene otherScene = scene;
        PatchSet otherPatches = patches;
        changes[i](otherScene, otherPatches);
        EXPECT_NE(sceneFingerprint(otherScene, otherPatches), before) << "change " << i;
    }
    // Names say nothing about light.
    scene.materials[0].name = "Paint";
    EXPECT_EQ(sceneFingerprint(scene, patches), before);
}

} // namespace relume
