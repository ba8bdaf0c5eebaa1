#include "io_test.h"
#include "souple/error.h"
#include "souple/files/endian.h"
#include "souple/io/particle_file.h"
#include "souple/mesh_files/mesh_write.h"

#include <algorithm>
#include <vector>

namespace souple::test::test_io_particle_file {

class ParticleFileTest : public FolderTest {
 protected:
  const std::vector<Vec3f> points_{{1, 2, 3}, {-0.5f, 1e-20f, 4e8f}};
  const std::vector<Vec3f> velocities_{{0, -9.81f, 0}, {7, 8, 9}};
};

/// Takes bytes apart, the high one first.
class BigEndianReader {
 public:
  explicit BigEndianReader(const std::string& text, std::size_t at = 0) : text_(text), at_(at) {}
  template <class T>
  T next() {
    const auto* bytes = reinterpret_cast<const std::byte*>(text_.data()) + at_;
    at_ += sizeof(T);
    return load<ByteOrder::big, T>(bytes);
  }
  Vec3f vector() {
    Vec3f v;
    for (int a = 0; a < 3; ++a) v[a] = std::bit_cast<float>(next<std::uint32_t>());
    return v;
  }
  std::size_t at() const { return at_; }

 private:
  const std::string& text_;
  std::size_t at_;
};

// The layout that Houdini 11 and Partio read.
TEST_F(ParticleFileTest, BgeoIsHoudinisClassicFormat) {
  const std::string bytes = particle_bytes(ParticleFormat::bgeo, points_, velocities_);
  ASSERT_EQ(bytes.substr(0, 5), "BgeoV");
  BigEndianReader in(bytes, 5);
  EXPECT_EQ(in.next<std::uint32_t>(), 5u);  // version
  EXPECT_EQ(in.next<std::uint32_t>(), 2u);  // points
  for (const std::uint32_t expected : {0u, 0u, 0u, 1u, 0u, 0u, 0u})
    EXPECT_EQ(in.next<std::uint32_t>(), expected);
  EXPECT_EQ(in.next<std::uint16_t>(), 1u);
  EXPECT_EQ(char(in.next<std::uint8_t>()), 'v');
  EXPECT_EQ(in.next<std::uint16_t>(), 3u);
  EXPECT_EQ(in.next<std::uint32_t>(), 5u);  // a vector
  EXPECT_EQ(in.vector(), Vec3f{});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(in.vector(), points_[i]);
    EXPECT_EQ(std::bit_cast<float>(in.next<std::uint32_t>()), 1.0f);
    EXPECT_EQ(in.vector(), velocities_[i]);
  }
  EXPECT_EQ(in.next<std::uint16_t>(), 0x00ffu);
  EXPECT_EQ(in.at(), bytes.size());
}

TEST_F(ParticleFileTest, VtkIsTheLegacyFormat) {
  const std::string bytes = particle_bytes(ParticleFormat::vtk, points_, velocities_);
  EXPECT_EQ(bytes.substr(0, 27), "# vtk DataFile Version 3.0\n");
  const auto after = [&](const std::string& words) {
    const std::size_t at = bytes.find(words);
    EXPECT_NE(at, std::string::npos) << words;
    return BigEndianReader(bytes, at + words.size());
  };
  after("\nBINARY\nDATASET POLYDATA\n");
  BigEndianReader points = after("POINTS 2 float\n"), vertices = after("VERTICES 2 4\n"),
                  velocities = after("POINT_DATA 2\nVECTORS velocity float\n");
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_EQ(points.vector(), points_[i]);
    EXPECT_EQ(velocities.vector(), velocities_[i]);
    EXPECT_EQ(vertices.next<std::uint32_t>(), 1u);
    EXPECT_EQ(vertices.next<std::uint32_t>(), i);
  }
  EXPECT_EQ(bytes[points.at()], '\n');
}

TEST_F(ParticleFileTest, PlyReadsBack) {
  for (const std::size_t count : {std::size_t{2}, std::size_t{0}}) {
    const std::span points(points_.data(), count), velocities(velocities_.data(), count);
    put("p.ply", particle_bytes(ParticleFormat::ply, points, velocities));
    const auto frame = read_particle_ply(folder / "p.ply");
    ASSERT_TRUE(frame);
    EXPECT_TRUE(std::equal(points.begin(), points.end(), frame->positions.begin(), frame->positions.end()));
    EXPECT_TRUE(
        std::equal(velocities.begin(), velocities.end(), frame->velocities.begin(), frame->velocities.end()));
  }
  put("p.ply", particle_bytes(ParticleFormat::ply, points_, {}));
  EXPECT_TRUE(read_particle_ply(folder / "p.ply")->velocities.empty());
}

TEST_F(ParticleFileTest, UnknownKindsOfFoamAreRefused) {
  const std::vector<std::uint8_t> known{0, 2}, unknown{1, 200};
  put("f.ply", ply_bytes(points_, velocities_, known));
  EXPECT_EQ(read_particle_ply(folder / "f.ply")->kinds, known);
  put("f.ply", ply_bytes(points_, velocities_, unknown));
  expect_error([&] { (void)read_particle_ply(folder / "f.ply"); }, {"point 1 has the kind 200"});
}

TEST_F(ParticleFileTest, VelocitiesOfMeshesAreRead) {
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, normals(3, Vec3f{0, 0, 1}),
      velocities{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  put("m.ply", ply_bytes(corners, normals, triangles, velocities));
  EXPECT_EQ(read_ply_velocities(folder / "m.ply"), velocities);
  put("m.ply", ply_bytes(corners, normals, triangles, {}));
  EXPECT_TRUE(read_ply_velocities(folder / "m.ply").empty());
  TriangleMesh colored;
  colored.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  colored.triangles = triangles;
  colored.colors.assign(3, Vec3f{1, 0, 0});
  const std::string bytes = ply_bytes(colored, corners, velocities);
  put("m.ply", bytes);
  EXPECT_EQ(read_ply_velocities(folder / "m.ply"), velocities);
  std::string apart = bytes;
  apart.insert(apart.find("property float vy"), "property float s\n");
  put("m.ply", apart);
  EXPECT_TRUE(read_ply_velocities(folder / "m.ply").empty());
  put("m.ply", bytes.substr(0, bytes.find("end_header") + 50));
  EXPECT_THROW(read_ply_velocities(folder / "m.ply"), Error);
  for (std::size_t length = 0; length < bytes.find("end_header"); ++length) {
    put("m.ply", bytes.substr(0, length));
    EXPECT_TRUE(read_ply_velocities(folder / "m.ply").empty()) << length;
  }
  EXPECT_THROW(ply_bytes(corners, std::span(normals).first(2), triangles, {}), Error);
}

TEST_F(ParticleFileTest, OtherFilesAreNotTaken) {
  put("p.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
  EXPECT_FALSE(read_particle_ply(folder / "p.ply"));
  const std::string whole = particle_bytes(ParticleFormat::ply, points_, velocities_);
  put("p.ply", whole.substr(0, whole.size() - 1));
  EXPECT_THROW(read_particle_ply(folder / "p.ply"), Error);
  EXPECT_THROW(particle_bytes(ParticleFormat::vtk, points_, std::span(velocities_).first(1)), Error);
}

}  // namespace souple::test::test_io_particle_file
