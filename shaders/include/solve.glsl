// Small dense symmetric positive definite systems, solved by LDL^T after scaling to unit diagonal.
#ifndef POSEFUSION_SOLVE
#define POSEFUSION_SOLVE

const float DAMPING = 1e-6;      // on the unit diagonal: keeps directions that nothing constrains from blowing up
const float LEAST_PIVOT = 1e-7;  // rounding of the diagonal; below it the matrix is taken for singular

// Solves A x = b, A n x n stored full, n <= 6. Returns false (x = 0) if A is not positive definite.
bool solve_spd(inout float A[36], inout float b[6], const int n, out float x[6]) {
    float scale[6];
    for (int i = 0; i < 6; ++i) x[i] = 0.0;
    for (int i = 0; i < n; ++i) {
        float d = A[i * 6 + i];
        if (!(d > 0.0)) return false;
        scale[i] = inversesqrt(d);
    }
    for (int i = 0; i < n; ++i) {
        b[i] *= scale[i];
        for (int j = 0; j < n; ++j) A[i * 6 + j] *= scale[i] * scale[j];
        A[i * 6 + i] += DAMPING;
    }
    for (int j = 0; j < n; ++j) {
        float d = A[j * 6 + j];
        for (int k = 0; k < j; ++k) d -= A[j * 6 + k] * A[j * 6 + k] * A[k * 6 + k];
        if (!(d > LEAST_PIVOT)) return false;
        A[j * 6 + j] = d;
        for (int i = j + 1; i < n; ++i) {
            float s = A[i * 6 + j];
            for (int k = 0; k < j; ++k) s -= A[i * 6 + k] * A[j * 6 + k] * A[k * 6 + k];
            A[i * 6 + j] = s / d;
        }
    }
    for (int i = 0; i < n; ++i) {
        x[i] = b[i];
        for (int k = 0; k < i; ++k) x[i] -= A[i * 6 + k] * x[k];
    }
    for (int i = n - 1; i >= 0; --i) {
        x[i] /= A[i * 6 + i];
        for (int k = i + 1; k < n; ++k) x[i] -= A[k * 6 + i] * x[k];
    }
    for (int i = 0; i < n; ++i) x[i] *= scale[i];
    return true;
}

#endif
