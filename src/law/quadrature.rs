//! The quadrature of integrals over an interval.

/// Points and weights of Gauss and Legendre's rule on 0 ≤ x ≤ 1, exact for polynomials of degree 5 (Abramowitz and
/// Stegun, *Handbook of Mathematical Functions*, table 25.4).
pub const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
