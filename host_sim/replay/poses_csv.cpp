#include "host_sim/replay/poses_csv.hpp"

#include <fmt/format.h>

namespace berth::host {
namespace {

// A fixed-point value is exact in double, and fmt rounds the exact value to nearest: the text
// depends on the packet's integer only.
std::string millimetres(Mm value) { return fmt::format("{:.6f}", to_double(value)); }
std::string unit(Unit value) { return fmt::format("{:.9f}", to_double(value)); }
std::string pixels(Px value) { return fmt::format("{:.6f}", to_double(value)); }
std::string degrees(Angle value) {
  return fmt::format("{:.9f}", to_double(value) * kDegreesPerRadian);
}
std::string variance(Q<24> value) { return fmt::format("{:.9f}", to_double(value)); }

std::string pose_fields(const WireTransform& pose) {
  const Mm* t = pose.translation_mm;
  const Quaternion& q = pose.rotation;
  return fmt::format("{},{},{},{},{},{},{}", millimetres(t[0]), millimetres(t[1]),
                     millimetres(t[2]), unit(q.w), unit(q.x), unit(q.y), unit(q.z));
}

std::string sigma_fields(const PoseCovariance& covariance) {
  const Angle* r = covariance.sigma_rotation;
  const Mm* t = covariance.sigma_translation_mm;
  return fmt::format("{},{},{},{},{},{}", degrees(r[0]), degrees(r[1]), degrees(r[2]),
                     millimetres(t[0]), millimetres(t[1]), millimetres(t[2]));
}

std::string marker_row(const std::string& file, const Marker& m) {
  const std::string start =
      fmt::format("{},{},{},{}", csv_field(file), marker_name(m), int{m.located}, int{m.used});
  if (!m.located) return start + ",,,,,,,,,,,,,,,\n";
  return fmt::format("{},{},{},{},{},{},{},{},,,,,,,,\n", start, pixels(m.center_px[0]),
                     pixels(m.center_px[1]), variance(m.variance_xx), variance(m.variance_xy),
                     variance(m.variance_yy), pixels(m.bias_px[0]), pixels(m.bias_px[1]));
}

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string poses_csv_header() {
  return "file,valid,reason,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,"
         "sigma_rx_deg,sigma_ry_deg,sigma_rz_deg,sigma_tx_mm,sigma_ty_mm,sigma_tz_mm,"
         "residual_px,markers,ambiguity,identified,ex_mm,ey_mm,ez_mm,eqw,eqx,eqy,eqz";
}

std::string poses_csv_row(const FrameRecord& record) {
  const PosePacket& p = record.pose;
  const std::string start =
      fmt::format("{},{},{}", csv_field(record.file), int{p.valid}, reason_name(p.reason));
  if (!p.has_pose) return fmt::format("{},,,,,,,,,,,,,,,,,{},,,,,,,", start, int{p.identified});
  // Zero stands for "no second pose": there is no ratio then.
  const std::string ambiguity =
      p.ambiguity.raw() == 0 ? "" : fmt::format("{:.6f}", to_double(p.ambiguity));
  return fmt::format("{},{},{},{},{},{},{},{}", start, pose_fields(p.camera_from_target),
                     sigma_fields(p.covariance), pixels(p.residual_px), int{p.markers_used},
                     ambiguity, int{p.identified}, pose_fields(p.effector_from_latch));
}

std::string markers_csv_header() {
  return "file,marker,located,used,x_px,y_px,var_xx_px2,var_xy_px2,var_yy_px2,bias_x_px,bias_y_px,"
         "tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,residual_px\n";
}

std::string markers_csv_rows(const FrameRecord& record) {
  std::string out;
  const MarkerSet& set = record.markers.set;
  for (int i = 0; i < set.count; ++i) out += marker_row(record.file, set.markers[i]);
  if (record.pose.has_second) {
    out += fmt::format("{},second_pose,,,,,,,,,,{},{}\n", csv_field(record.file),
                       pose_fields(record.pose.second), pixels(record.pose.second_residual_px));
  }
  return out;
}

std::string tum_row(const FrameRecord& record, std::size_t index, std::uint32_t period_us) {
  if (!record.valid()) return {};
  const double time_s = static_cast<double>(index) * period_us * 1e-6;
  const Mm* t = record.pose.camera_from_target.translation_mm;
  const Quaternion& q = record.pose.camera_from_target.rotation;
  return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {} {} {} {}\n", time_s, to_double(t[0]) * 1e-3,
                     to_double(t[1]) * 1e-3, to_double(t[2]) * 1e-3, unit(q.x), unit(q.y),
                     unit(q.z), unit(q.w));
}

}  // namespace berth::host
