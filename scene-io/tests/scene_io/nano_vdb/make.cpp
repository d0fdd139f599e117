// Writes the files beside it by NanoVDB itself (32.4.2, of OpenVDB 10.0.1):
//   g++ -std=c++17 -DNANOVDB_USE_ZIP -DNANOVDB_USE_BLOSC make.cpp -lz -lblosc -o make && ./make
// The voxels are those that ../nano_vdb/others.rs expects.
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>
#include <string>

using namespace nanovdb;

template <typename T> T value(int n) { return T(((n * 29) % 64) / 8.0 - 2.0); }
template <> Vec3f value(int n) { return Vec3f(value<float>(n), value<float>(n + 1), value<float>(n + 2)); }
template <> Vec3d value(int n) { return Vec3d(value<double>(n), value<double>(n + 1), value<double>(n + 2)); }

template <typename Build, typename T> void make(const char *name, io::Codec codec, T background)
{
    GridBuilder<T, Build> builder(background);
    auto accessor = builder.getAccessor();
    for (int n = 0; n < 200; ++n) {
        accessor.setValue(Coord((n * 37) % 20 - 10, (n * 61) % 18 + 120, (n * 13) % 16), value<T>(n));
    }
    Map map;
    const Vec3d matrix[3] = {{0.5, 0.25, 0}, {0, 2, 0.125}, {-0.5, 0, 1}}, unused[3] = {};
    map.set(matrix, unused, Vec3d(1, -2, 3), 1.0);
    auto handle = builder.getHandle(map, name);
    io::writeGrid(std::string(name) + ".nvdb", handle, codec);
}

int main()
{
    make<float, float>("float", io::Codec::ZIP, 0.5f);
    make<float, float>("blosc", io::Codec::BLOSC, 0.5f);
    make<double, double>("double", io::Codec::ZIP, 0.5);
    make<Vec3f, Vec3f>("Vec3f", io::Codec::ZIP, Vec3f(0.5f));
    make<Vec3d, Vec3d>("Vec3d", io::Codec::ZIP, Vec3d(0.5));
    make<Fp4, float>("Fp4", io::Codec::ZIP, 0.5f);
    make<Fp8, float>("Fp8", io::Codec::ZIP, 0.5f);
    make<Fp16, float>("Fp16", io::Codec::ZIP, 0.5f);
    make<FpN, float>("FpN", io::Codec::ZIP, 0.5f);
    make<int32_t, int32_t>("int32", io::Codec::ZIP, 0);
}
