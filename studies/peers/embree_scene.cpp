#include <carom/studies/peers/embree_scene.hpp>

#include <embree3/rtcore.h>

#include <cstring>
#include <stdexcept>

namespace carom::peers {

struct EmbreeScene::Handles {
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    ~Handles() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

EmbreeScene::EmbreeScene(const MeshData& mesh, const EmbreeSettings& settings) : handles_(std::make_unique<Handles>()) {
    const RTCBuildQuality quality = settings.high_quality ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
    rtcSetSceneFlags(handles_->scene, settings.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(handles_->scene, quality);
    RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality);
    void* const vertices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), mesh.vertices.size());
    void* const triangles =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(mesh.triangles[0]), mesh.triangles.size());
    if (vertices == nullptr || triangles == nullptr) throw std::runtime_error("Embree has no room for the mesh");
    std::memcpy(vertices, mesh.vertices.data(), sizeof(vec3) * mesh.vertices.size());
    std::memcpy(triangles, mesh.triangles.data(), sizeof(mesh.triangles[0]) * mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handles_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(handles_->scene);
    if (rtcGetDeviceError(handles_->device) != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the mesh");
}

EmbreeScene::~EmbreeScene() = default;

EmbreeHit EmbreeScene::closest_hit(const geo::Ray<float>& ray) const noexcept {
    RTCRayHit query;
    query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
    query.ray.tnear = ray.t_min, query.ray.tfar = ray.t_max;
    query.ray.time = 0.0f, query.ray.mask = 0xffffffffu, query.ray.flags = 0, query.ray.id = 0;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(handles_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.primID};
}

std::string EmbreeScene::version() { return RTC_VERSION_STRING; }

}  // namespace carom::peers
