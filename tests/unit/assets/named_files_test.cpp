// Which files a model that is no glTF file names.
#include "assets/foreign/named_files.h"

#include "tests/unit/foreign_files.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

using test::writeFile;
using Paths = std::vector<std::string>;

class NamedFiles : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    std::string write(const std::string& name, const std::string& text = "x") const {
        return writeFile(folder_, name, text);
    }
    /// Returns the sorted names, relative to the folder, of what a model names.
    Paths named(const std::string& model) const {
        Paths names;
        for (const std::string& file : namedFiles(path(model)))
            names.push_back(std::filesystem::relative(file, folder_.path()).string());
        std::sort(names.begin(), names.end());
        return names;
    }
    const TemporaryFolder folder_;
};

TEST_F(NamedFiles, AreAnObjsLibraryAndItsPictures) {
    write("m/house.obj", "# house.obj\nmtllib My paints.mtl\nv 0.5 0.25 .1\n");
    write("m/My paints.mtl",
          "newmtl a\nmap_Kd -s 2 2 wall.PNG\nmap_d ..\\shared\\leaf.tga\nmap_Ke gone.png\n");
    write("m/wall.png");
    write("m/other.png");
    write("shared/leaf.tga");
    EXPECT_EQ(named("m/house.obj"), (Paths{"m/My paints.mtl", "m/wall.png", "shared/leaf.tga"}));
    write("m/house.mtl");
    EXPECT_EQ(named("m/house.obj").front(), "m/My paints.mtl");
    EXPECT_EQ(named("m/house.obj").size(), 4u) << "libassimp takes a library of the model's name as well";
}

TEST_F(NamedFiles, AreFoundInTextAndInBinaryFiles) {
    write("images/red wall.jpg");
    write("a.tif");
    write("d.dae", "<image><init_from>file:///C:/art/images/red%20wall.jpg</init_from></image>");
    EXPECT_EQ(named("d.dae"), Paths{"images/red wall.jpg"});
    const std::string zero(1, '\0');
    write("b.fbx", "Kaydara FBX Binary  " + zero + "S\x18" + zero + zero + zero +
                       "C:\\images\\Red Wall.jpgS\x05" + zero + zero + zero + "a.tifI");
    EXPECT_EQ(named("b.fbx"), (Paths{"a.tif", "images/red wall.jpg"}));
}

TEST_F(NamedFiles, AreFoundWhereverTheyStandInALargeFile) {
    write("wall.png");
    constexpr size_t kPiece = 1 << 20; // [bytes], which are read at once
    const std::string name = "\"wall.png\"";
    for (size_t shift = 0; shift < name.size() + 2; ++shift) {
        write("large.dae", std::string(kPiece - shift, '.') + name + std::string(kPiece, ' '));
        EXPECT_EQ(named("large.dae"), Paths{"wall.png"}) << shift;
    }
    write("end.dae", std::string(kPiece - name.size(), ' ') + name);
    EXPECT_EQ(named("end.dae"), Paths{"wall.png"});
}

TEST_F(NamedFiles, AreNoneFarAwayAndNoneOfWhatIsNoFile) {
    write("wall.png");
    write("far/away/model/m.obj", "mtllib ../../../wall.png\n");
    EXPECT_EQ(named("far/away/model/m.obj"), Paths{});
    EXPECT_EQ(named("missing.obj"), Paths{});
    EXPECT_EQ(namedFiles("/dev/zero"), Paths{});
    write("many.dae", [] {
        std::string text;
        for (int i = 0; i < 5000; ++i)
            text += "\"" + std::to_string(i) + ".png\"";
        return text + "\"wall.png\"";
    }());
    EXPECT_EQ(named("many.dae"), Paths{}) << "so many names are no model's: it comes to an end";
}

} // namespace
} // namespace relume
