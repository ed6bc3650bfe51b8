// Layers are baked as jobs, each of some of the scene's lights: the joined file has the bytes of one bake.
// The scripts of assets/jobs do so by GNU parallel (or xargs) and, with programs that stand for Slurm's, as
// Slurm's jobs.
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace relume {
namespace {

using JobWords = std::vector<std::string>;

const std::string kJobs = RELUME_SOURCE_DIR "/assets/jobs/";

class LayerJobs : public testing::Test {
protected:
    /// The scene has five mesh lights. A sky and lamps, of which one is off, are added.
    LayerJobs() {
        const ProcessResult edited =
            runRelume({"edit", RELUME_SOURCE_DIR "/assets/scenes/octagon.glb", "-o", scene_, "--add",
                       "point,name=Bulb,position=0,2,0", "--add", "disc,name=Disc,position=1,2,1", "--add",
                       "point,name=Off,position=0,1,0,intensity=0", "--set", "Bulb.name=Bulb, left", "--set",
                       "Sky.intensity=2"});
        EXPECT_EQ(edited.status, 0) << edited.err;
        setenv("RELUME", RELUME_BINARY, 1);
    }

    std::string path(const std::string& name) const { return folder_.path(name); }

    std::string bake(const std::string& name, const JobWords& options, const JobWords& more = {}) const {
        JobWords words = {"bake", scene_, "--size", "48", "--layers", "-o", path(name)};
        words.insert(words.end(), options.begin(), options.end());
        words.insert(words.end(), more.begin(), more.end());
        const ProcessResult result = runRelume(words);
        EXPECT_EQ(result.status, 0) << result.err;
        return path(name);
    }

    ProcessResult join(const JobWords& files, const std::string& to, const JobWords& more = {}) const {
        JobWords words = {"mix", "--join"};
        words.insert(words.end(), files.begin(), files.end());
        words.insert(words.end(), {"-o", to});
        words.insert(words.end(), more.begin(), more.end());
        return runRelume(words);
    }

    JobWords lights() const {
        const ProcessResult listed = runRelume({"info", scene_, "--light-names"});
        EXPECT_EQ(listed.status, 0) << listed.err;
        std::istringstream lines(listed.out);
        JobWords names;
        for (std::string line; std::getline(lines, line);)
            names.push_back(line);
        return names;
    }

    /// Bakes the lights in three jobs, dealt in turn, and joins them.
    std::string bakeInJobs(const JobWords& options, const JobWords& ofJoin = {}) const {
        std::vector<std::string> jobs(3);
        const JobWords names = lights();
        for (size_t i = 0; i < names.size(); ++i)
            jobs[i % jobs.size()] += (i < jobs.size() ? "" : ",") + names[i];
        JobWords files;
        for (size_t i = 0; i < jobs.size(); ++i)
            files.push_back(bake("job" + std::to_string(i) + ".exr", options, {"--lights", jobs[i]}));
        const ProcessResult joined = join(files, path("joined.exr"), ofJoin);
        EXPECT_EQ(joined.status, 0) << joined.err;
        return path("joined.exr");
    }

    const TemporaryFolder folder_;
    const std::string scene_ = folder_.path("level with 'odd' name.glb");
};

void expectSameBytes(const std::string& a, const std::string& b) {
    const std::string bytes = bytesOf(a);
    EXPECT_FALSE(bytes.empty()) << a;
    EXPECT_TRUE(bytes == bytesOf(b)) << a << " differs from " << b;
}

TEST_F(LayerJobs, LightsAreNamedOnePerLine) {
    const JobWords names = lights();
    ASSERT_EQ(names.size(), 9u);
    EXPECT_EQ(names.front(), "Lamp 1");
    EXPECT_EQ(names[5], "Bulb, left");
    EXPECT_EQ(names.back(), "Sky");
}

TEST_F(LayerJobs, JoinToTheBytesOfOneBake) {
    const JobWords options = {"--samples", "32"};
    expectSameBytes(bakeInJobs(options), bake("whole.exr", options));
}

TEST_F(LayerJobs, ThatEachHaveTheirErrorJoinToTheBytesOfOneBake) {
    const JobWords options = {"--samples", "256", "--layer-error", "0.1"};
    expectSameBytes(bakeInJobs(options), bake("whole.exr", options));
}

TEST_F(LayerJobs, InHalvesJoinToTheBytesOfOneBake) {
    const JobWords options = {"--samples", "16", "--half"};
    expectSameBytes(bakeInJobs(options, {"--half"}), bake("whole.exr", options));
}

TEST_F(LayerJobs, GoOnFromTheirOwnCheckpointsAlone) {
    const std::string checkpoint = path("checkpoint");
    const JobWords options = {"--samples", "128", "--lights", "Lamp 1,Lamp 2"};
    const std::string first =
        bake("a.exr", options, {"--checkpoint", checkpoint, "--checkpoint-every", "0.05"});
    ASSERT_TRUE(std::filesystem::exists(checkpoint));
    const ProcessResult other =
        runRelume({"bake", scene_, "--size", "48", "--layers", "--samples", "128", "--lights",
                   "Lamp 1,Lamp 3", "-o", path("b.exr"), "--resume", checkpoint});
    EXPECT_EQ(other.status, 1);
    EXPECT_TRUE(contains(other.err, "lights=")) << other.err;
    expectSameBytes(first, bake("c.exr", options, {"--resume", checkpoint}));
}

TEST_F(LayerJobs, AreRefusedForLightsThatAreNotThere) {
    for (const auto& [typed, why] :
         {std::pair{"Lamp 1,Moon", "'Moon' is no light"}, {"Sky,Sky", "'Sky' is named twice"}}) {
        const ProcessResult result =
            runRelume({"bake", scene_, "-o", path("a.exr"), "--layers", "--lights", typed});
        EXPECT_EQ(result.status, 2);
        EXPECT_TRUE(contains(result.err, why)) << result.err;
        EXPECT_TRUE(contains(result.err, "'Bulb, left', 'Disc', 'Off', 'Sky'")) << result.err;
        EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
    }
}

TEST_F(LayerJobs, ThatDifferAreNotJoined) {
    const std::string a = bake("a.exr", {"--samples", "16", "--lights", "Lamp 1,Sky"});
    const std::string b = bake("b.exr", {"--samples", "16", "--lights", "Sky"});
    const std::string c = bake("c.exr", {"--samples", "32", "--lights", "Disc"});
    for (const auto& [other, why] :
         {std::pair{b, "has layer 'Sky', which"}, {c, "samples=32, not samples=16"}}) {
        const ProcessResult result = join({a, other}, path("joined.exr"));
        EXPECT_EQ(result.status, 1);
        EXPECT_TRUE(contains(result.err, why)) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_FALSE(std::filesystem::exists(path("joined.exr")));
    }
}

TEST_F(LayerJobs, ByParallelHaveTheBytesOfOneBake) {
    const std::string output = path("by parallel.exr");
    const ProcessResult result =
        runProgram(kJobs + "parallel.sh", {scene_, output, "--size", "48", "--samples", "16"});
    ASSERT_EQ(result.status, 0) << result.err;
    expectSameBytes(output, bake("whole.exr", {"--samples", "16"}));
    EXPECT_FALSE(std::filesystem::exists(output + ".jobs"));
}

TEST_F(LayerJobs, GoOnWithTheFilesThatAreMissing) {
    const std::string output = path("out.exr"), jobs = output + ".jobs";
    ASSERT_EQ(runProgram(kJobs + "begin_jobs.sh", {scene_, jobs, "--size", "48", "--samples", "16"}).out,
              "9\n");
    const ProcessResult first =
        runProgram(kJobs + "bake_lights.sh", {"2", "0", scene_, jobs, "--size", "48", "--samples", "16"});
    ASSERT_EQ(first.status, 0) << first.err;
    ASSERT_TRUE(std::filesystem::exists(jobs + "/2.exr"));
    const auto written = std::filesystem::last_write_time(jobs + "/2.exr");
    const ProcessResult other =
        runProgram(kJobs + "parallel.sh", {scene_, output, "--size", "48", "--samples", "32"});
    EXPECT_EQ(other.status, 1);
    EXPECT_TRUE(contains(other.err, "is of another bake")) << other.err;
    const ProcessResult again =
        runProgram(kJobs + "bake_lights.sh", {"1", "1", scene_, jobs, "--size", "48", "--samples", "16"});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(std::filesystem::last_write_time(jobs + "/2.exr"), written);
    const ProcessResult joined =
        runProgram(kJobs + "parallel.sh", {scene_, output, "--size", "48", "--samples", "16"});
    ASSERT_EQ(joined.status, 0) << joined.err;
    expectSameBytes(output, bake("whole.exr", {"--samples", "16"}));
}

/// Programs that stand for Slurm's: a batch is run at once, task by task, and tasks of srun side by side.
class SlurmJobs : public LayerJobs {
protected:
    SlurmJobs() {
        std::filesystem::create_directory(path("bin"));
        write("sbatch",
              "tasks=none\n"
              "for word; do case $word in --array=1-*) tasks=$(seq \"${word#--array=1-}\") ;; esac; done\n"
              "echo \"$@\" >>\"$FAKE_LOG\"\nscript=$(cat)\n"
              "for task in $tasks; do SLURM_ARRAY_TASK_ID=$task bash -c \"$script\" || exit 1; done\n"
              "echo '7;cluster'\n");
        write("srun", "shift 2 # --mpi=none --kill-on-bad-exit=0\n"
                      "for task in 0 1 2; do SLURM_PROCID=$task SLURM_NTASKS=3 \"$@\" & done\nwait\n");
        setenv("FAKE_LOG", path("log").c_str(), 1);
        setenv("PATH", (path("bin") + ":" + before_).c_str(), 1);
    }
    ~SlurmJobs() override { setenv("PATH", before_.c_str(), 1); }

    void write(const std::string& name, const std::string& text) const {
        const std::string program = path("bin/" + name);
        std::ofstream(program) << "#!/usr/bin/env bash\nset -e\n" << text;
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    }

private:
    const std::string before_ = std::getenv("PATH");
};

TEST_F(SlurmJobs, OfAnArrayHaveTheBytesOfOneBake) {
    const std::string output = path("by slurm.exr");
    setenv("SBATCH_OPTIONS", "--mem=4G --gpus-per-task=1", 1);
    const ProcessResult result =
        runProgram(kJobs + "slurm_array.sh", {scene_, output, "--size", "48", "--samples", "16"});
    unsetenv("SBATCH_OPTIONS");
    ASSERT_EQ(result.status, 0) << result.err;
    expectSameBytes(output, bake("whole.exr", {"--samples", "16"}));
    const std::string asked = bytesOf(path("log"));
    EXPECT_TRUE(contains(asked, "--array=1-9 ")) << asked;
    EXPECT_TRUE(contains(asked, "--dependency=afterok:7 ")) << asked;
    EXPECT_EQ(std::count(asked.begin(), asked.end(), '\n'), 2) << asked;
    EXPECT_TRUE(contains(asked, "--mem=4G --gpus-per-task=1\n")) << asked;
}

TEST_F(SlurmJobs, OfAnAllocationHaveTheBytesOfOneBake) {
    const std::string output = path("by slurm.exr");
    const ProcessResult result =
        runProgram(kJobs + "slurm_srun.sh", {scene_, output, "--size", "48", "--samples", "16"});
    ASSERT_EQ(result.status, 0) << result.err;
    expectSameBytes(output, bake("whole.exr", {"--samples", "16"}));
}

} // namespace
} // namespace relume
