#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>

#include "tests/bench/wrench_bench_peers.h"

namespace forcelayer::bench {
namespace {

// Bullet computes in float and is made for bodies of about a unit: lengths are in decimetres.
constexpr double kUnitsPerM = 10;
constexpr float kMarginUnits = static_cast<float>(1e-6 * kUnitsPerM);

btVector3 bullet(const glm::dvec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}
glm::dvec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

std::unique_ptr<btTriangleMesh> triangles_of(const mesh::Mesh& mesh) {
  auto triangles = std::make_unique<btTriangleMesh>();
  const auto vertex = [&](std::uint32_t i) {
    const mesh::Vec3d& v = mesh.vertices[i];
    return bullet(kUnitsPerM * glm::dvec3(v[0], v[1], v[2]));
  };
  for (const mesh::Triangle& t : mesh.triangles) {
    triangles->addTriangle(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  return triangles;
}

// Sums what contactPairTest() reports, in Bullet's units.
struct Sum : btCollisionWorld::ContactResultCallback {
  const btCollisionObject* part = nullptr;
  btVector3 center;
  glm::dvec3 force{0}, torque{0};

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const double depth = -double{point.getDistance()};
    if (!(depth > 0)) return 0;
    // The normal points out of the second body.
    const bool part_is_first = first->getCollisionObject() == part;
    const glm::dvec3 push =
        depth * from_bullet(point.m_normalWorldOnB) * (part_is_first ? 1.0 : -1.0);
    const btVector3& at = part_is_first ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
    force += push;
    torque += glm::cross(from_bullet(at - center), push);
    return 0;
  }
};

class BulletContacts final : public MeshContacts {
 public:
  explicit BulletContacts(const mesh::Mesh& part)
      : part_triangles_(triangles_of(part)),
        part_shape_(part_triangles_.get()),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {  // for contactPairTest()
      dispatcher_.registerClosestPointsCreateFunc(GIMPACT_SHAPE_PROXYTYPE, type, &create_);
      dispatcher_.registerClosestPointsCreateFunc(type, GIMPACT_SHAPE_PROXYTYPE, &create_);
    }
    part_shape_.setMargin(kMarginUnits);
    part_shape_.updateBound();
    part_.setCollisionShape(&part_shape_);
    world_.addCollisionObject(&part_);
  }
  ~BulletContacts() override {
    world_.removeCollisionObject(&part_);
    if (scene_shape_) world_.removeCollisionObject(&scene_);
  }

  void set_scene(const mesh::Mesh& scene) override {
    constexpr std::size_t kMostTriangles = 1 << 21;  // that its tree numbers; more crash it
    if (scene.triangles.size() >= kMostTriangles) {
      throw std::runtime_error("a mesh has more triangles than Bullet can number");
    }
    if (scene_shape_) world_.removeCollisionObject(&scene_);
    scene_shape_.reset();
    scene_triangles_ = triangles_of(scene);
    scene_shape_ = std::make_unique<btBvhTriangleMeshShape>(scene_triangles_.get(), true);
    scene_shape_->setMargin(kMarginUnits);
    scene_.setCollisionShape(scene_shape_.get());
    world_.addCollisionObject(&scene_);
  }

  Wrench at(const Pose& world_from_part) override {
    const glm::dmat3 r = glm::mat3_cast(world_from_part.orientation);
    btMatrix3x3 basis;
    for (int row = 0; row < 3; ++row) {
      basis[row] = bullet({r[0][row], r[1][row], r[2][row]});
    }
    Sum sum;
    sum.part = &part_;
    sum.center = bullet(kUnitsPerM * world_from_part.position_m);
    part_.setWorldTransform(btTransform(basis, sum.center));
    world_.contactPairTest(&part_, &scene_, sum);
    return {sum.force / kUnitsPerM, sum.torque / (kUnitsPerM * kUnitsPerM)};
  }

 private:
  std::unique_ptr<btTriangleMesh> scene_triangles_, part_triangles_;
  std::unique_ptr<btBvhTriangleMeshShape> scene_shape_;
  btGImpactMeshShape part_shape_;
  btGImpactCollisionAlgorithm::CreateFunc create_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  btCollisionObject scene_, part_;
};

}  // namespace

std::unique_ptr<MeshContacts> bullet_contacts(const mesh::Mesh& part) {
  return std::make_unique<BulletContacts>(part);
}

}  // namespace forcelayer::bench
