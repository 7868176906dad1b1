#pragma once
#include <Eigen/SparseCholesky>

#include "engine/loops/deformation_energy.hpp"

/// The linear system of one Gauss-Newton step, six unknowns per free node.
namespace posefusion {

class NormalEquations {
public:
    /// Builds the sparsity pattern and analyses it, once. @param is_free  per node
    NormalEquations(const DeformationEnergy& energy, std::span<const GraphNode> nodes,
                    const std::vector<bool>& is_free);

    /// Sums up J^T J and J^T r at the transforms of `nodes`.
    void assemble(const DeformationEnergy& energy, std::span<const GraphNode> nodes);
    /// Step (w, v) of each node, zero for those that are not free. @param damping  added to the diagonal, relative to
    /// its mean. False if the system cannot be solved.
    bool solve(double damping, std::vector<Eigen::Matrix<double, 6, 1>>& step);

    /// Lower triangle of J^T J, and J^T r; block k belongs to the k-th free node.
    [[nodiscard]] const Eigen::SparseMatrix<double>& hessian() const { return hessian_; }
    [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }

private:
    static constexpr int kFixed = -1;
    [[nodiscard]] double* column(int block_column, int block_row, int k);

    std::vector<int> block_of_node_;      ///< kFixed for fixed nodes
    std::vector<std::vector<int>> rows_;  ///< per block column: block rows below the diagonal, ascending
    Eigen::SparseMatrix<double> hessian_;
    Eigen::VectorXd gradient_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver_;
};

}  // namespace posefusion
