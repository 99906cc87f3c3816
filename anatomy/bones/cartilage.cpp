#include "anatomy/bones/cartilage.h"

#include <cmath>

#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {

std::vector<CartilageRule> read_cartilage_rules(const std::filesystem::path& tables) {
  const Table table(tables / "cartilage.csv");
  std::vector<CartilageRule> rules;
  for (int row = 0; row < table.rows(); ++row)
    rules.push_back({table.text(row, "bone"), int(table.number(row, "faces")),
                     table.number(row, "from"), table.number(row, "to"),
                     table.number(row, "aside")});
  return rules;
}

std::vector<char> cartilage_faces(const std::vector<CartilageRule>& rules, const Bone& bone) {
  std::vector<char> cartilage(bone.mesh.F.rows(), 0);
  for (const CartilageRule& rule : rules) {
    if (rule.bone != bone.name || rule.faces != bone.mesh.F.rows()) continue;
    const Eigen::RowVector3d low = bone.mesh.V.colwise().minCoeff(),
                             high = bone.mesh.V.colwise().maxCoeff();
    const double middle = 0.5 * (low.x() + high.x()), half = 0.5 * (high.x() - low.x()),
                 height = high.y() - low.y();
    for (Eigen::Index f = 0; f < bone.mesh.F.rows(); ++f) {
      Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
      for (int k = 0; k < 3; ++k) at += bone.mesh.V.row(bone.mesh.F(f, k)) / 3;
      const double up = (at.y() - low.y()) / height;
      if (up >= rule.from && up < rule.to && std::abs(at.x() - middle) > rule.aside * half)
        cartilage[f] = 1;
    }
  }
  return cartilage;
}

}  // namespace ecorche::inline v1
