// Small dense symmetric positive definite systems, solved by LDL^T after scaling to unit diagonal.
#ifndef POSEFUSION_SOLVE
#define POSEFUSION_SOLVE

// Unknowns of the largest system: a pose; define it before for others.
#ifndef SOLVE_UNKNOWNS
#define SOLVE_UNKNOWNS 6
#endif
const int UNKNOWNS = SOLVE_UNKNOWNS;
const float DAMPING = 1e-6;      // on the unit diagonal: keeps directions that nothing constrains from blowing up
const float LEAST_PIVOT = 1e-7;  // rounding of the diagonal; below it the matrix is taken for singular

// Solves A x = b, A n x n stored full in rows of UNKNOWNS, n <= UNKNOWNS. Returns false (x = 0) if A is not positive
// definite.
bool solve_spd(inout float A[UNKNOWNS * UNKNOWNS], inout float b[UNKNOWNS], const int n, out float x[UNKNOWNS]) {
    float scale[UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; ++i) x[i] = 0.0;
    for (int i = 0; i < n; ++i) {
        float d = A[i * UNKNOWNS + i];
        if (!(d > 0.0)) return false;
        scale[i] = inversesqrt(d);
    }
    for (int i = 0; i < n; ++i) {
        b[i] *= scale[i];
        for (int j = 0; j < n; ++j) A[i * UNKNOWNS + j] *= scale[i] * scale[j];
        A[i * UNKNOWNS + i] += DAMPING;
    }
    for (int j = 0; j < n; ++j) {
        float d = A[j * UNKNOWNS + j];
        for (int k = 0; k < j; ++k) d -= A[j * UNKNOWNS + k] * A[j * UNKNOWNS + k] * A[k * UNKNOWNS + k];
        if (!(d > LEAST_PIVOT)) return false;
        A[j * UNKNOWNS + j] = d;
        for (int i = j + 1; i < n; ++i) {
            float s = A[i * UNKNOWNS + j];
            for (int k = 0; k < j; ++k) s -= A[i * UNKNOWNS + k] * A[j * UNKNOWNS + k] * A[k * UNKNOWNS + k];
            A[i * UNKNOWNS + j] = s / d;
        }
    }
    for (int i = 0; i < n; ++i) {
        x[i] = b[i];
        for (int k = 0; k < i; ++k) x[i] -= A[i * UNKNOWNS + k] * x[k];
    }
    for (int i = n - 1; i >= 0; --i) {
        x[i] /= A[i * UNKNOWNS + i];
        for (int k = i + 1; k < n; ++k) x[i] -= A[k * UNKNOWNS + i] * x[k];
    }
    for (int i = 0; i < n; ++i) x[i] *= scale[i];
    return true;
}

#endif
