//! What the figures of e say.

use super::super::Failure;
use super::super::figure::Section;
use super::super::plant::Plant;
use super::super::statistics::small;
use super::claims::claims;
use super::view::{NOISE, PUBLISHED, View, by_plant};
use super::{Errors, Point};

pub fn section(measured: &[(Point, Errors)]) -> Result<Section, Failure> {
    let views = Plant::ALL.map(|plant| View::new(plant, measured));
    let [duffing, van_der_pol] = views;
    let views = [duffing?, van_der_pol?];
    let tables: String = views.iter().map(View::table).collect();
    let text = format!(
        "The publication's plants with one law throughout, both sensors with Gaussian noise of std σ, sampled every 1 ms. Its abscissa is \
         called the intensity 2D of the noise, from 0 to 0.2. Read as the density of a white noise it would be σ² · 1 ms (the column 2D); but its \
         printed e = 2.58e-4 for Duffing, 12 s, at 0.1 belongs to σ = 0.1: the published method has a median of {} there. So σ is what its \
         abscissa says.\n\nOurs is the streaming identifier with its default configuration, read at these times of one run (its memory is 30 s: \
         at 40 s it has seen the last 30). The published method identifies from a first window of that length. e is the mean over the seeds, the \
         median in brackets; the limit is the Cramér–Rao bound of e, a mean as well: \
         half of it is a good median. For van der Pol both methods are given the full cubic library of 11 terms; the limit is that of the four true terms, \
         beside it that of all 11.\n\n{}\n\n{tables}",
        small(views[0].median(PUBLISHED, NOISE, 12.0)),
        by_plant(&views, |view| view.against_limit()) + ".",
    );
    let pictures = views.iter().flat_map(|view| [view.against_noise(), view.against_length()]).collect();
    let title = "Error against noise and length of record";
    Ok(Section { title, text, pictures, claims: claims(&views) })
}
