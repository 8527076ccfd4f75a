// What a camera must be to be accepted, each field by its name, and that what is accepted works.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "camera/validate_camera.hpp"
#include "cameras.hpp"

namespace berth_test {
namespace {

std::string fault_of(const berth::Camera& camera) {
  const berth::FieldFault fault = berth::validate_camera(camera);
  return fault.is_fault() ? fault.field : "";
}

TEST(ValidateCamera, AcceptsGoodCameras) {
  for (const NamedCamera& c : valid_cameras()) EXPECT_EQ(fault_of(c.camera), "") << c.name;
}

TEST(ValidateCamera, NamesTheFieldThatIsWrong) {
  const struct {
    const char* field;
    std::function<void(berth::Camera&)> spoil;
  } cases[] = {
      {"camera.width", [](auto& c) { c.width = 0; }},
      {"camera.width", [](auto& c) { c.width = 1025; }},
      {"camera.height", [](auto& c) { c.height = -3; }},
      {"camera.fx", [](auto& c) { c.fx = berth::Px(-1250); }},
      {"camera.fx", [](auto& c) { c.fx = berth::Px(0); }},
      {"camera.fx", [](auto& c) { c.fx = berth::Px(9000); }},
      {"camera.fy", [](auto& c) { c.fy = berth::Px(3); }},
      {"camera.fy", [](auto& c) { c.fy = berth::Px(3000); }},
      {"camera.cx", [](auto& c) { c.cx = berth::Px::lowest(); }},
      {"camera.cy", [](auto& c) { c.cy = berth::Px(5000); }},
      {"camera.p1", [](auto& c) { c.p1 = berth::Coefficient::lowest(); }},
      {"camera.p2", [](auto& c) { c.p2 = berth::Coefficient(1); }},
      {"camera.distortion", [](auto& c) { c.k1 = berth::Coefficient(-3); }},
      {"camera.distortion", [](auto& c) { c.k3 = berth::Coefficient::lowest(); }},
      {"camera.distortion", [](auto& c) { c.fx = c.fy = berth::Px(200); }},  // beyond 127 deg
  };
  for (const auto& test : cases) {
    berth::Camera camera = valid_cameras()[0].camera;
    test.spoil(camera);
    EXPECT_EQ(fault_of(camera), test.field);
  }
}

// Slope of the radial function in double: d(r d)/dr.
double radial_slope(const berth::Camera& c, double r) {
  const double q = r * r;
  return 1 + q * (3 * real(c.k1) + q * (5 * real(c.k2) + q * 7 * real(c.k3)));
}

TEST(ValidateCamera, AcceptedCamerasUndistortTheirWholeImage) {
  Random random;
  int accepted = 0;
  for (int n = 0; n < 600; ++n) {
    const double focal = 350 * std::pow(4050.0 / 350, random.uniform(0, 1));
    const double r2 = 2 * std::pow(512 / focal, 2);  // at the corner
    const berth::Camera camera =
        make_camera(focal, random.uniform(-0.3, 0.3) / r2, random.uniform(-0.15, 0.15) / (r2 * r2),
                    random.uniform(-0.002, 0.002), random.uniform(-0.002, 0.002),
                    std::clamp(random.uniform(-0.1, 0.1) / (r2 * r2 * r2), -127.0, 127.0));
    if (!fault_of(camera).empty()) continue;
    ++accepted;
    const CvCamera reference(camera);
    for (int i = 0; i < 50; ++i) {
      const berth::Vec2Px pixel{nearest<16>(random.uniform(-0.5, 1023.5)),
                                nearest<16>(random.uniform(-0.5, 1023.5))};
      const berth::Vec2Ray ray = berth::undistort(camera, pixel);
      const cv::Point2d back = reference.project({real(ray[0]), real(ray[1]), 1});
      EXPECT_NEAR(back.x, real(pixel[0]), 0x1p-14) << focal;
      EXPECT_NEAR(back.y, real(pixel[1]), 0x1p-14) << focal;
      EXPECT_GT(radial_slope(camera, std::hypot(real(ray[0]), real(ray[1]))), 0);
    }
  }
  EXPECT_GT(accepted, 300);
}

TEST(ValidateCamera, AnyBitPatternIsALegalInput) {
  Random random;
  for (int n = 0; n < 300; ++n) {
    berth::Camera camera = valid_cameras()[0].camera;
    berth::Coefficient* const coefficients[] = {&camera.k1, &camera.k2, &camera.k3};
    for (berth::Coefficient* k : coefficients) *k = berth::Coefficient::from_raw(random.any32());
    if (n % 2 == 0) camera.cx = berth::Px::from_raw(random.any32());
    if (n % 3 == 0) camera.fx = berth::Px::from_raw(random.any32());
    if (n % 5 == 0) camera.p1 = berth::Coefficient::from_raw(random.any32());
    berth::validate_camera(camera);
  }
}

}  // namespace
}  // namespace berth_test
