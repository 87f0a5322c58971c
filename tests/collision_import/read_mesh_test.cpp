// Mesh files of every format: the same tetrahedron from each, and a typed error from whatever is damaged.
#include <collision_import/mesh_texts.hpp>
#include <fuzz/mesh_file_check.hpp>

#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include <unistd.h>

namespace carom {
namespace {

using test::MeshText;

// A folder of its own, removed with everything in it.
class Folder {
public:
    Folder() : path_(std::filesystem::temp_directory_path() / ("carom_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path(name);
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

private:
    std::filesystem::path path_;
};

// The corners of each triangle.
using Soup = std::vector<std::array<std::array<float, 3>, 3>>;

Soup soup_of(const MeshData& mesh) {
    Soup out;
    for (const auto& t : mesh.triangles) {
        auto& corners = out.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) corners[k] = {mesh.vertices[t[k]].x, mesh.vertices[t[k]].y, mesh.vertices[t[k]].z};
    }
    return out;
}

Soup tetrahedron() {
    Soup out;
    for (const auto& f : test::kFaces) out.push_back({test::kCorners[f[0]], test::kCorners[f[1]], test::kCorners[f[2]]});
    return out;
}

// What parse_mesh says against a text; Ok stands for no error.
std::string verdict(const std::string& text, MeshFormat format) {
    const Result<MeshData> mesh = parse_mesh(text, format, "place");
    if (mesh) return "Ok";
    EXPECT_EQ(mesh.error().where, "place");
    EXPECT_NE(mesh.error().message, "");
    return to_string(mesh.error().code);
}

TEST(ParseMesh, EveryFormatHoldsTheSameTetrahedron) {
    for (const MeshText& file : test::mesh_texts()) {
        const Result<MeshData> mesh = parse_mesh(file.text, file.format, file.name);
        ASSERT_TRUE(mesh) << file.name << ": " << mesh.error().message;
        EXPECT_EQ(soup_of(*mesh), tetrahedron()) << file.name;
        const Result<TriangleMeshPtr> built = TriangleMesh::build(mesh->vertices, mesh->triangles);
        ASSERT_TRUE(built) << file.name;
        EXPECT_TRUE((*built)->is_closed()) << file.name;
    }
}

TEST(ParseMesh, WhateverIsTruncatedIsRefused) {
    for (const MeshText& file : test::mesh_texts()) {
        const std::size_t whole = file.text.find_last_not_of(" \n\r") + 1;  // a text is whole without its last line's end
        for (std::size_t size = 0; size < file.text.size(); ++size) {
            const std::string result = verdict(file.text.substr(0, size), file.format);
            const bool known = size + file.optional_end < whole;
            EXPECT_TRUE(known ? result == "Parse" : result == "Parse" || result == "Ok" || result == "Empty")
                << file.name << " of " << size << " bytes: " << result;
        }
    }
}

TEST(ParseMesh, EmptyFilesAndOtherFilesAreNotMeshes) {
    for (const MeshText& file : test::mesh_texts()) {
        const bool obj = file.format == MeshFormat::Obj;  // an empty text is an OBJ file of nothing
        EXPECT_EQ(verdict("", file.format), obj ? "Empty" : "Parse") << file.name;
        EXPECT_EQ(verdict("\n\n", file.format), obj ? "Empty" : "Parse") << file.name;
        EXPECT_EQ(verdict("hello world\n", file.format), "Parse") << file.name;
        EXPECT_EQ(verdict(std::string(1000, '\0'), file.format), "Parse") << file.name;
        for (const MeshText& other : test::mesh_texts()) {
            if (other.format == file.format) continue;
            EXPECT_NE(verdict(other.text, file.format), "Ok") << other.name << " as " << file.name;
        }
    }
}

TEST(ParseMesh, PointsAndLinesAreLeftOut) {
    EXPECT_EQ(verdict("v 0 0 0\nv 1 0 0\np 1\nl 1 2\n", MeshFormat::Obj), "Empty");
    EXPECT_EQ(verdict("OFF 2 2 0\n0 0 0\n1 0 0\n1 0\n2 0 1\n", MeshFormat::Off), "Empty");
    EXPECT_EQ(verdict("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n",
                      MeshFormat::Ply),
              "Empty");
    EXPECT_EQ(verdict("solid\nendsolid\n", MeshFormat::Stl), "Empty");
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":0})", R"(,"mode":1)")), MeshFormat::Gltf), "Empty");
    const Result<MeshData> mixed = parse_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nf 1 2 3\np 3\n", MeshFormat::Obj, "");
    ASSERT_TRUE(mixed);
    EXPECT_EQ(mixed->triangles.size(), 1u);
}

TEST(ParseMesh, PositionsThatNoFloatHoldsAreRefused) {
    for (const char* x : {"nan", "inf", "-infinity", "1e39", "-4e400"}) {
        const std::string s(x);
        EXPECT_EQ(verdict("v 0 0 0\nv 1 0 0\nv 0 1 " + s + "\nf 1 2 3\n", MeshFormat::Obj), "NotFinite") << x;
        EXPECT_EQ(verdict("OFF 3 1 0\n0 0 0\n1 0 " + s + "\n0 1 0\n3 0 1 2\n", MeshFormat::Off), "NotFinite") << x;
        std::string ply = test::kPly;
        EXPECT_EQ(verdict(ply.replace(ply.find("0.1 9"), 3, s), MeshFormat::Ply), "NotFinite") << x;
    }
    for (const float x : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::string stl = test::binary_stl();
        EXPECT_EQ(verdict(stl.replace(84 + 12 + 4, 4, test::raw(x)), MeshFormat::Stl), "NotFinite");
        std::string buffer = test::gltf_buffer();
        buffer.replace(8, 4, test::raw(x));
        EXPECT_EQ(verdict(test::glb(test::gltf_json("{}"), buffer), MeshFormat::Gltf), "NotFinite");
    }
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":0,"scale":[1e300,1e300,1]})")), MeshFormat::Gltf), "NotFinite");
}

TEST(ParseMesh, NumbersAreRoundedOnce) {
    const Result<MeshData> mesh =
        parse_mesh("v +1 .5 -0\nv 1e-60 1e-400 16777217\nv 0.1 1.00000017881393432617187499 3.4028235e38\nf 1 2 3\n", MeshFormat::Obj, "");
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->vertices[0], vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(mesh->vertices[1], vec3(0.0f, 0.0f, 16777216.0f));
    // Just below the middle of two floats; by way of a double it would be rounded up.
    EXPECT_EQ(mesh->vertices[2], vec3(0.1f, 1.00000011920928955078125f, std::numeric_limits<float>::max()));
}

TEST(ParseMesh, IndicesOutOfRangeAreNamed) {
    EXPECT_EQ(verdict("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", MeshFormat::Obj), "Parse");
    EXPECT_EQ(verdict("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", MeshFormat::Obj), "Parse");
    EXPECT_EQ(verdict("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", MeshFormat::Obj), "Parse");
    EXPECT_EQ(verdict("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", MeshFormat::Off), "Parse");
    EXPECT_EQ(verdict("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", MeshFormat::Off), "Parse");
    std::string ply = test::binary_ply(false);
    EXPECT_EQ(verdict(ply.replace(ply.size() - 4, 4, test::raw(std::int32_t{-1})), MeshFormat::Ply), "Parse");
    EXPECT_EQ(verdict(ply.replace(ply.size() - 4, 4, test::raw(std::int32_t{4})), MeshFormat::Ply), "Parse");
    std::string buffer = test::gltf_buffer();
    buffer.back() = 4;
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}"), buffer), MeshFormat::Gltf), "Parse");
    const Result<MeshData> bad = parse_mesh("v 0 0 0\n\n# x\nf 1 1 7\n", MeshFormat::Obj, "f.obj");
    EXPECT_NE(bad.error().message.find("line 4"), std::string::npos) << bad.error().message;
}

// Headers that claim gigabytes; the readers must say so before they ask for the memory.
TEST(ParseMesh, ClaimsAreCheckedAgainstTheFile) {
    EXPECT_EQ(verdict("OFF 4000000000 1 0\n0 0 0\n", MeshFormat::Off), "Parse");
    EXPECT_EQ(verdict("OFF 1 4000000000 0\n0 0 0\n", MeshFormat::Off), "Parse");
    EXPECT_EQ(verdict("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", MeshFormat::Off), "Parse");
    const std::string head = "ply\nformat binary_little_endian 1.0\nelement ",
                      xyz = "property float x\nproperty float y\nproperty float z\n";
    EXPECT_EQ(verdict(head + "vertex 4000000000\n" + xyz + "end_header\n" + std::string(12, '\0'), MeshFormat::Ply), "Parse");
    EXPECT_EQ(verdict(head + "nothing 4000000000\nend_header\n", MeshFormat::Ply), "Parse");
    EXPECT_EQ(verdict(head + "list 1\nproperty list uint char a\nend_header\n" + std::string(4, '\xff'), MeshFormat::Ply), "Parse");
    std::string stl = test::binary_stl();
    EXPECT_EQ(verdict(stl.replace(80, 4, test::raw(0xffffffffu)), MeshFormat::Stl), "Parse");
    for (const char* key : {"\"count\":12", "\"byteLength\":48", "\"byteOffset\":48"}) {
        std::string json = test::gltf_json("{}");
        json.replace(json.find(key), std::string(key).size(), std::string(key, std::string(key).find(':')) + ":18446744073709551615");
        EXPECT_EQ(verdict(test::glb(json), MeshFormat::Gltf), "Parse") << key;
    }
}

TEST(ParseMesh, WhatFollowsTheEndIsRefused) {
    EXPECT_EQ(verdict(test::kOff + "3 0 1 2\n", MeshFormat::Off), "Parse");
    EXPECT_EQ(verdict(test::kPly + "3 0 1 2\n", MeshFormat::Ply), "Parse");
    EXPECT_EQ(verdict(test::binary_ply(true) + "x", MeshFormat::Ply), "Parse");
    EXPECT_EQ(verdict(test::binary_stl() + "x", MeshFormat::Stl), "Parse");
    EXPECT_EQ(verdict(test::text_stl() + "x\n", MeshFormat::Stl), "Parse");
    EXPECT_EQ(verdict(test::text_stl() + test::text_stl(), MeshFormat::Stl), "Ok") << "several solids are one mesh";
    EXPECT_EQ(verdict(test::glb() + "x", MeshFormat::Gltf), "Parse");
}

TEST(ParseMesh, KindsThatAreNotReadSaySo) {
    EXPECT_EQ(verdict("OFF BINARY\n", MeshFormat::Off), "WrongType");
    EXPECT_EQ(verdict("4OFF\n1 0 0\n", MeshFormat::Off), "WrongType");
    EXPECT_EQ(verdict("STCNOFF 3 1 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 0.5 0.5 0.5\n", MeshFormat::Off), "Ok");
    EXPECT_EQ(
        verdict("ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n1 0\n", MeshFormat::Ply),
        "WrongType");
    const auto with = [](const char* what) {
        std::string json = test::gltf_json("{}");
        return test::glb(json.replace(json.size() - 1, 1, std::string(",") + what + "}"));
    };
    EXPECT_EQ(verdict(with(R"("extensionsRequired":["KHR_draco_mesh_compression"])"), MeshFormat::Gltf), "WrongType");
    EXPECT_EQ(verdict(with(R"("extensionsRequired":["KHR_materials_unlit"])"), MeshFormat::Gltf), "Ok");
    std::string old = test::gltf_json("{}");
    EXPECT_EQ(verdict(test::glb(old.replace(old.find("2.0"), 3, "1.0")), MeshFormat::Gltf), "WrongType");
    EXPECT_EQ(verdict(test::gltf_json(R"({"uri":"buffer.bin"})"), MeshFormat::Gltf), "WrongType") << "text has no folder";
}

double area(const MeshData& mesh, const vec3& normal) {
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
        const dvec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
        const double part = 0.5 * glm::dot(glm::cross(b - a, c - a), dvec3(normal));
        EXPECT_GE(part, 0.0) << "no triangle of a plane face may be turned over";
        sum += part;
    }
    return sum;
}

// A pseudo-random star: a polygon with a point that sees all of it, mostly concave, turned into another plane.
TEST(ParseMesh, PolygonsAreCutIntoTrianglesOfTheSameArea) {
    Random random(31);
    for (int round = 0; round < 300; ++round) {
        const int corners = 4 + static_cast<int>(random.unit() * 30);
        std::string text, face = "f";
        double wanted = 0.0;
        std::vector<std::array<double, 2>> points;
        for (int i = 0; i < corners; ++i) {
            const double angle = 6.283185307179586 * i / corners, radius = random.range(0.2, 1.0);
            points.push_back({static_cast<double>(static_cast<float>(radius * std::cos(angle))),
                              static_cast<double>(static_cast<float>(radius * std::sin(angle)))});
        }
        for (int i = 0; i < corners; ++i) {
            const auto& p = points[static_cast<std::size_t>(i)];
            const auto& q = points[static_cast<std::size_t>((i + 1) % corners)];
            wanted += 0.5 * (p[0] * q[1] - p[1] * q[0]);
            char line[128];
            std::snprintf(line, sizeof line, "v 7 %.9g %.9g\n", p[0], p[1]);
            text += line;
            face += " " + std::to_string(i + 1);
        }
        const Result<MeshData> mesh = parse_mesh(text + face + "\n", MeshFormat::Obj, "star");
        ASSERT_TRUE(mesh) << mesh.error().message;
        EXPECT_EQ(mesh->triangles.size(), static_cast<std::size_t>(corners - 2));
        EXPECT_NEAR(area(*mesh, {1, 0, 0}), wanted, 1e-12);
    }
}

TEST(ParseMesh, AFaceThatCrossesItselfStaysWhole) {
    const Result<MeshData> bow = parse_mesh("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", MeshFormat::Obj, "bow");
    ASSERT_TRUE(bow);
    EXPECT_EQ(bow->triangles.size(), 2u);
    std::string text, face = "f";
    for (int i = 0; i < 1100; ++i) {
        text += "v " + std::to_string(i % 2 == 0 ? i : -i) + " " + std::to_string(i * i % 97) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    EXPECT_EQ(verdict(text + face + "\n", MeshFormat::Obj), "Parse") << "concave and large";
}

TEST(ParseMesh, NodesPlaceAndMirrorMeshes) {
    const auto placed = [](const std::string& node) {
        const Result<MeshData> mesh = parse_mesh(test::glb(test::gltf_json("{}", node)), MeshFormat::Gltf, "node");
        EXPECT_TRUE(mesh) << node << (mesh ? "" : mesh.error().message);
        return mesh ? *mesh : MeshData{};
    };
    const MeshData moved =
        placed(R"({"mesh":0,"translation":[1,2,3],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,1,1]})");
    ASSERT_EQ(moved.vertices.size(), 4u);
    EXPECT_NEAR(glm::distance(moved.vertices[1], vec3(1, 4, 3)), 0.0f, 1e-6f) << "x is doubled, turned onto y, then moved";
    EXPECT_NEAR(glm::distance(moved.vertices[2], vec3(0, 2, 3)), 0.0f, 1e-6f);
    const MeshData mirrored = placed(R"({"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})");
    const auto volume = [](const MeshData& mesh) {
        double sum = 0.0;
        for (const auto& t : mesh.triangles) {
            sum += glm::dot(dvec3(mesh.vertices[t[0]]), glm::cross(dvec3(mesh.vertices[t[1]]), dvec3(mesh.vertices[t[2]]))) / 6.0;
        }
        return sum;
    };
    EXPECT_GT(volume(mirrored), 0.016) << "still counter-clockwise seen from outside";
    const MeshData child = placed(R"({"translation":[0,0,1],"children":[1]},{"mesh":0,"scale":[2,2,2]})");
    EXPECT_EQ(child.vertices[1], vec3(2, 0, 1));
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":0,"children":[0]})")), MeshFormat::Gltf), "Parse") << "a ring";
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":0,"children":[9]})")), MeshFormat::Gltf), "Parse");
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":3})")), MeshFormat::Gltf), "Parse");
    EXPECT_EQ(verdict(test::glb(test::gltf_json("{}", R"({"mesh":0,"scale":[1,2]})")), MeshFormat::Gltf), "Parse");
}

TEST(ParseMesh, StripsAndFansTurnTheSameWay) {
    for (const auto& [mode, wanted] : {std::pair{5, Soup::value_type{test::kCorners[1], test::kCorners[2], test::kCorners[0]}},
                                       std::pair{6, Soup::value_type{test::kCorners[0], test::kCorners[1], test::kCorners[0]}}}) {
        const std::string json = test::gltf_json("{}", R"({"mesh":0})", ",\"mode\":" + std::to_string(mode));
        const Result<MeshData> mesh = parse_mesh(test::glb(json), MeshFormat::Gltf, "strip");  // of 0 2 1 0 1 3 ...
        ASSERT_TRUE(mesh);
        ASSERT_EQ(mesh->triangles.size(), 10u);
        Soup::value_type second = soup_of(*mesh)[1];
        // The same triangle from any corner on.
        while (second[0] != wanted[0] || second[1] != wanted[1]) {
            std::ranges::rotate(second, second.begin() + 1);
            if (second == soup_of(*mesh)[1]) break;
        }
        EXPECT_EQ(second, wanted) << "mode " << mode;
    }
}

TEST(ReadMesh, FilesThatAreMissingNoFilesOrTooLargeAreRefused) {
    const Folder folder;
    const auto code = [](const std::string& path) {
        const Result<MeshData> mesh = read_mesh(path);
        EXPECT_TRUE(mesh || mesh.error().where == path);
        return mesh ? "Ok" : to_string(mesh.error().code);
    };
    EXPECT_STREQ(code(folder.path("none.off")), "Io");
    EXPECT_STREQ(code(folder.path("x.doc")), "WrongType");
    EXPECT_STREQ(code(""), "WrongType");
    std::filesystem::create_directory(folder.path("folder.off"));
    EXPECT_STREQ(code(folder.path("folder.off")), "Io");
    const std::string file = folder.write("T.OFF", test::kOff);
    EXPECT_STREQ(code(file), "Ok") << "capitals";
    EXPECT_STREQ(code(file + "/x.off"), "Io");
    const std::string large = folder.write("large.stl", "");
    std::filesystem::resize_file(large, kMostMeshFileBytes + 1);  // takes no room on the disk
    EXPECT_STREQ(code(large), "InvalidArgument");
}

TEST(ReadMesh, BuffersOfGltfLieInItsFolder) {
    const Folder folder;
    (void)folder.write("my buffer.bin", test::gltf_buffer());
    EXPECT_TRUE(read_mesh(folder.write("a.gltf", test::gltf_json(R"({"uri":"my%20buffer.bin"})"))));
    const auto code = [&](const char* uri) {
        const Result<MeshData> mesh = read_mesh(folder.write("b.gltf", test::gltf_json(std::string(R"({"uri":")") + uri + "\"}")));
        return mesh ? "Ok" : to_string(mesh.error().code);
    };
    EXPECT_STREQ(code("none.bin"), "Io");
    EXPECT_STREQ(code("../buffer.bin"), "WrongType");
    EXPECT_STREQ(code("/etc/hostname"), "WrongType");
    EXPECT_STREQ(code("https://example.org/buffer.bin"), "WrongType");
    EXPECT_STREQ(code("my%2"), "Parse");
    EXPECT_STREQ(code("data:;base64,!!!!"), "Parse");
}

// The fuzzer's own check over its seeds and over bytes that lie.
TEST(ParseMesh, DamagedFilesAreRefusedOrBuild) {
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/mesh_file")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        EXPECT_EQ(test::mesh_file_fault({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), "") << entry.path();
    }
    Random random(8);
    for (const MeshText& file : test::mesh_texts()) {
        for (int round = 0; round < 3000; ++round) {
            std::string text = static_cast<char>(file.format) + file.text;
            for (int k = 0; k < 1 + round % 4; ++k) {
                text[1 + static_cast<std::size_t>(random.unit() * static_cast<double>(text.size() - 1))] =
                    static_cast<char>(random.unit() * 256.0);
            }
            ASSERT_EQ(test::mesh_file_fault({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), "")
                << file.name << " " << round;
        }
    }
}

}  // namespace
}  // namespace carom
