#include "engine/loops/normal_equations.hpp"

#include <algorithm>

namespace posefusion {

NormalEquations::NormalEquations(const DeformationEnergy& energy, std::span<const GraphNode> nodes,
                                 const std::vector<bool>& is_free) {
    block_of_node_.assign(nodes.size(), kFixed);
    int blocks = 0;
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (is_free[i]) block_of_node_[i] = blocks++;
    }
    rows_.resize(static_cast<size_t>(blocks));
    EnergyTerm term;
    for (size_t t = 0; t < energy.terms(); ++t) {
        energy.evaluate(t, nodes, term);
        for (size_t a = 0; a < term.count; ++a) {
            for (size_t b = 0; b < a; ++b) {
                const auto [low, high] = std::minmax(block_of_node_[term.node[a]], block_of_node_[term.node[b]]);
                if (low != kFixed) rows_[static_cast<size_t>(low)].push_back(high);
            }
        }
    }
    // column by column: the lower half of the diagonal block, then the blocks below it
    Eigen::VectorXi sizes(6 * blocks);
    for (int b = 0; b < blocks; ++b) {
        auto& rows = rows_[static_cast<size_t>(b)];
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        for (int k = 0; k < 6; ++k) sizes[6 * b + k] = 6 - k + 6 * static_cast<int>(rows.size());
    }
    hessian_.resize(6 * blocks, 6 * blocks);
    hessian_.reserve(sizes);
    for (int b = 0; b < blocks; ++b) {
        for (int k = 0; k < 6; ++k) {
            for (int r = k; r < 6; ++r) hessian_.insert(6 * b + r, 6 * b + k) = 0;
            for (const int row : rows_[static_cast<size_t>(b)]) {
                for (int r = 0; r < 6; ++r) hessian_.insert(6 * row + r, 6 * b + k) = 0;
            }
        }
    }
    hessian_.makeCompressed();
    gradient_.setZero(6 * blocks);
    solver_.analyzePattern(hessian_);
}

/// Where the values of column k of a block begin; for a diagonal block those of row 0, though rows above k are not
/// stored.
double* NormalEquations::column(int block_column, int block_row, int k) {
    double* first = hessian_.valuePtr() + hessian_.outerIndexPtr()[6 * block_column + k];
    if (block_row == block_column) return first - k;
    const auto& rows = rows_[static_cast<size_t>(block_column)];
    return first + 6 - k + 6 * (std::lower_bound(rows.begin(), rows.end(), block_row) - rows.begin());
}

void NormalEquations::assemble(const DeformationEnergy& energy, std::span<const GraphNode> nodes) {
    std::fill_n(hessian_.valuePtr(), hessian_.nonZeros(), 0.0);
    gradient_.setZero();
    EnergyTerm term;
    for (size_t t = 0; t < energy.terms(); ++t) {
        energy.evaluate(t, nodes, term);
        for (size_t a = 0; a < term.count; ++a) {
            const int row = block_of_node_[term.node[a]];
            if (row == kFixed) continue;
            gradient_.segment<6>(6 * row) += term.jacobian[a].transpose() * term.residual;
            for (size_t b = 0; b < term.count; ++b) {
                const int col = block_of_node_[term.node[b]];
                if (col == kFixed || col > row) continue;
                const Eigen::Matrix<double, 6, 6> product = term.jacobian[a].transpose() * term.jacobian[b];
                for (int k = 0; k < 6; ++k) {
                    double* values = column(col, row, k);
                    for (int r = row == col ? k : 0; r < 6; ++r) values[r] += product(r, k);
                }
            }
        }
    }
}

bool NormalEquations::solve(double damping, std::vector<Eigen::Matrix<double, 6, 1>>& step) {
    const double mean = hessian_.rows() > 0 ? hessian_.diagonal().mean() : 0;
    solver_.setShift(damping * mean);
    solver_.factorize(hessian_);
    if (solver_.info() != Eigen::Success) return false;
    const Eigen::VectorXd x = solver_.solve(-gradient_);
    if (!x.allFinite()) return false;
    for (size_t i = 0; i < step.size(); ++i) {
        if (block_of_node_[i] == kFixed)
            step[i].setZero();
        else
            step[i] = x.segment<6>(6 * block_of_node_[i]);
    }
    return true;
}

}  // namespace posefusion
