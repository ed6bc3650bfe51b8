// Classes stay small: those of the whole house are counted, and the count is tried on classes of a known
// size.
#include "tests/text.h"
#include "tests/unit/class_sizes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace relume {
namespace {

constexpr size_t kMostData = 25, kMostFunctions = 45, kMostFiles = 2;

struct SourceFile {
    std::string name, text;
};

std::vector<SourceFile> sourceFiles() {
    namespace fs = std::filesystem;
    std::vector<SourceFile> files;
    for (const char* folder : {"app", "assets", "bake", "renderer"}) {
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(RELUME_SOURCE_DIR) / folder)) {
            const std::string kind = entry.path().extension().string();
            if (kind != ".h" && kind != ".cpp") continue;
            std::ostringstream text;
            text << std::ifstream(entry.path()).rdbuf();
            files.push_back({fs::relative(entry.path(), RELUME_SOURCE_DIR).string(), text.str()});
        }
    }
    return files;
}

ClassSize only(const std::string& source) {
    const std::vector<ClassSize> sizes = classSizes(source);
    EXPECT_EQ(sizes.size(), 1u);
    return sizes.empty() ? ClassSize() : sizes.front();
}

} // namespace

TEST(ClassSizes, NoClassIsLarge) {
    const std::vector<SourceFile> files = sourceFiles();
    ASSERT_GT(files.size(), 300u);
    size_t classes = 0;
    for (const SourceFile& file : files) {
        for (const ClassSize& size : classSizes(file.text)) {
            EXPECT_LE(size.data, kMostData) << file.name << ": " << size.name;
            EXPECT_LE(size.functions, kMostFunctions) << file.name << ": " << size.name;
            ++classes;
        }
    }
    EXPECT_GT(classes, 500u);
}

TEST(ClassSizes, NoClassIsSpreadOverManyFiles) {
    std::set<std::string> names;
    std::map<std::string, std::set<std::string>> files;
    for (const SourceFile& file : sourceFiles()) {
        for (const ClassSize& size : classSizes(file.text))
            names.insert(size.name);
        if (file.name.ends_with(".h")) continue;
        // Two rooms may each have a class of one name.
        const std::string room = file.name.substr(0, file.name.rfind('/') + 1);
        for (const std::string& name : classesImplementedIn(file.text))
            files[room + name].insert(file.name);
    }
    EXPECT_GT(files.size(), 150u);
    for (const auto& [name, in] : files)
        EXPECT_TRUE(in.size() <= kMostFiles || !names.contains(name.substr(name.rfind('/') + 1))) << name;
}

TEST(ClassSizes, DataIsCountedNameByName) {
    EXPECT_EQ(only("struct A { int a, b = 2; std::map<int, float> c; float d[3] = {1, 2, 3}; };").data, 4u);
    EXPECT_EQ(only("class A { public:\n int a_ = f(1, 2); // x, y\n const char* b = \"a, b; c\"; };").data,
              2u);
    EXPECT_EQ(only("struct A { static constexpr int kA = 1, kB = 2; using B = int; friend class C; };").data,
              0u);
    EXPECT_EQ(only("struct A { std::function<void(int, int)> f; };").data, 1u);
}

TEST(ClassSizes, FunctionsAreCountedWithAndWithoutABody) {
    const ClassSize size = only(R"(class A final : public B {
public:
    A(int a, int b) : a_(a), b_{b} {}
    int a() const { return a_; }
    virtual void f(int x = g(1)) = 0;
    bool operator==(const A&) const = default;
private:
    int a_ = 0, b_ = 0;
};)");
    EXPECT_EQ(size.functions, 4u);
    EXPECT_EQ(size.data, 2u);
}

TEST(ClassSizes, NestedTypesCountByThemselves) {
    const std::vector<ClassSize> sizes = classSizes(
        "struct A { struct B { int x, y, z; int f() { return x; } }; enum class C { D, E }; B b; };");
    ASSERT_EQ(sizes.size(), 2u);
    EXPECT_EQ(sizes[0].name, "A");
    EXPECT_EQ(sizes[0].data, 1u);
    EXPECT_EQ(sizes[0].functions, 0u);
    EXPECT_EQ(sizes[1].data, 3u);
    EXPECT_EQ(sizes[1].functions, 1u);
}

TEST(ClassSizes, FilesTellWhatTheyImplement) {
    const std::vector<std::string> names =
        classesImplementedIn("A::A(int x) : x_(x) {}\nint B::f() const {\n    return C::g();\n}\n");
    EXPECT_EQ(names, (std::vector<std::string>{"A", "B"}));
}

} // namespace relume
