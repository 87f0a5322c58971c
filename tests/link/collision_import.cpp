// carom::collision_import linked alone.
#include <carom/collision/import/read_mesh.hpp>

int main() {
    const auto mesh = carom::parse_mesh("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", carom::MeshFormat::Off, "text");
    return mesh && mesh->triangles.size() == 1 ? 0 : 1;
}
