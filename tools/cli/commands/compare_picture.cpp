#include "tools/cli/commands/compare_picture.h"

#include "gliss/surface/names.h"
#include "tools/report/report_data.h"

namespace gliss::tools {

Json picture_json(const std::vector<std::pair<Construction, SurfacePicture>>& pictures,
                  double unit) {
  Json json = Json::array();
  for (const auto& [construction, picture] : pictures) {
    const auto per_metre = [unit](double curvature) { return number(curvature / unit); };
    std::vector<float> curvature, departure;
    for (const float k : picture.curvature)
      curvature.push_back(static_cast<float>(static_cast<double>(k) / unit));
    for (const float d : picture.departure)
      departure.push_back(static_cast<float>(static_cast<double>(d) * unit));
    json.push_back({{"construction", name_of(kConstructionNames, construction)},
                    {"points", picture.face.size()},
                    {"p50_curvature", per_metre(picture.p50)},
                    {"p99_curvature", per_metre(picture.p99)},
                    {"max_curvature", per_metre(picture.largest)},
                    {"face", packed(picture.face)},
                    {"position", packed(picture.position)},
                    {"normal", packed(picture.normal)},
                    {"spot", packed(picture.spot)},
                    {"curvature", packed(curvature)},
                    {"departure", packed(departure)}});
  }
  return json;
}

Json jumps_json(const std::vector<WalkJump>& jumps) {
  Json json = Json::array();
  for (const WalkJump& jump : jumps) {
    json.push_back({{"position", {jump.scp.x(), jump.scp.y(), jump.scp.z()}},
                    {"face", jump.face},
                    {"step", jump.step},
                    {"lost", jump.lost}});
  }
  return json;
}

}  // namespace gliss::tools
