//! A motion that nothing is known of but its smoothness: (q, q̇, q̈) driven by a white jerk.
//!
//! q̈ is a Wiener process of intensity Q, (m/s³)² s (Bar-Shalom, Li and Kirubarajan, *Estimation with Applications to
//! Tracking and Navigation*, 2001, 6.2.3); readings of q and q̇ have white noise of variance R. The filter's
//! innovations e with variance s give the likelihood of Q and R.

use crate::estimation::covariance::Matrix;
use crate::estimation::filter::{Channel, Filter};

/// q, q̇, q̈ and their covariance.
pub type Kinematics = Filter<3>;

/// How many times its own square the variance of the first velocity, and of the first acceleration, is: ten stds of
/// what a first difference tells.
const FAR: f64 = 100.0;

/// Begins at two successive values of a channel, `dt` s apart, with noise of that variance, at the second one's time.
/// What is not measured is 0, and exact where nothing will tell it.
pub fn begin(channel: Channel, [before, now]: [f64; 2], dt: f64, variance: f64) -> Kinematics {
    let slope = (now - before) / dt;
    let spread = |order: i32| FAR * (variance + (now - before).powi(2)) / dt.powi(2 * order);
    match channel {
        Channel::Q => Filter::begin([now, slope, 0.0], [variance, spread(1), spread(2)]),
        Channel::Qd => Filter::begin([0.0, now, slope], [0.0, variance, spread(1)]),
    }
}

/// Goes on by `dt` s under a white jerk of that intensity.
pub fn advance(kinematics: &mut Kinematics, dt: f64, intensity: f64) {
    kinematics.mean = carried(kinematics.mean, dt);
    kinematics.predict(|change| carried(change, dt), &white_jerk(intensity, dt));
}

/// A v: where (q, q̇, q̈) is after `dt` s without jerk.
pub fn carried([q, qd, qdd]: [f64; 3], dt: f64) -> [f64; 3] {
    [q + dt * (qd + 0.5 * dt * qdd), qd + dt * qdd, qdd]
}

/// What it adds to the covariance in `dt` s.
fn white_jerk(intensity: f64, dt: f64) -> Matrix<3> {
    let [first, second, third] = [intensity * dt, intensity * dt * dt / 2.0, intensity * dt.powi(3) / 3.0];
    let (fourth, fifth) = (intensity * dt.powi(4) / 8.0, intensity * dt.powi(5) / 20.0);
    let cross = intensity * dt.powi(3) / 6.0;
    [[fifth, fourth, cross], [fourth, third, second], [cross, second, first]]
}
