//! Groups of joints that share one law.

use iwan_core::FourParameter;
use iwan_fem::{Assembled, NamedModes};

use crate::error::Error;

/// Two joints move alike where their slips differ by less than this part of the largest slip of all, as in coupled modal models.
const ALIKE: f64 = 0.01;

/// Joints that share one four-parameter law, the same in all their directions.
#[derive(Debug, Clone, PartialEq)]
pub struct JointGroup {
    /// Name of the group in results.
    pub name: String,
    /// Indices of the joints among those of the structure.
    pub joints: Vec<usize>,
    /// Law with the start values of the search.
    pub law: FourParameter,
}

/// A joint's index and the law with which its search starts.
pub type StartLaw = (usize, FourParameter);

/// Groups joints whose slips have the same size in all these modes, such as the left and the right end of a part: no measurement of these modes can
/// tell such joints apart. Only joints with the same start law are grouped.
///
/// # Errors
/// [`Error::Structure`] for a mode that does not exist.
///
/// ```
/// use iwan_fem::{NamedModes, mesh::beam::Configuration, paper};
/// use iwan_study::update::groups_that_move_alike;
/// let named = NamedModes::new(&paper::structure(Configuration::A, 1)?, 12)?;
/// let laws: Vec<_> = (0..4).map(|joint| (joint, paper::joint().unwrap())).collect();
/// let groups = groups_that_move_alike(&named, &laws, &["bending 1", "bending 3"])?;
/// let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
/// assert_eq!(names, ["left link + right link", "left washer + right washer"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn groups_that_move_alike(
    named: &NamedModes,
    laws: &[StartLaw],
    modes: &[&str],
) -> Result<Vec<JointGroup>, Error> {
    let modes = modes
        .iter()
        .map(|name| named.named(name).map_err(Error::structure(name)))
        .collect::<Result<Vec<_>, _>>()?;
    let sizes = |joint: usize| -> Vec<f64> {
        let of = slips_of(&named.assembled, joint);
        let size = |unknown: usize| modes.iter().map(move |m| named.stuck.shape(m.pair.stuck)[unknown].abs());
        of.into_iter().flat_map(|slip| size(named.assembled.slips()[slip].unknown)).collect()
    };
    let all: Vec<Vec<f64>> = laws.iter().map(|(joint, _)| sizes(*joint)).collect();
    let largest = all.iter().flatten().fold(0.0_f64, |most, b| most.max(*b));
    let mut groups: Vec<(usize, JointGroup)> = Vec::new();
    for (n, (joint, law)) in laws.iter().enumerate() {
        let alike = |first: usize| {
            all[first].len() == all[n].len()
                && all[first].iter().zip(&all[n]).all(|(a, b)| (a - b).abs() <= ALIKE * largest)
        };
        let name = &named.assembled.structure().joints[*joint].name;
        match groups.iter_mut().find(|(first, group)| group.law == *law && alike(*first)) {
            Some((_, group)) => {
                group.name = format!("{} + {name}", group.name);
                group.joints.push(*joint);
            }
            None => groups.push((n, JointGroup { name: name.clone(), joints: vec![*joint], law: *law })),
        }
    }
    Ok(groups.into_iter().map(|(_, group)| group).collect())
}

/// Indices, among all slips, of a joint's slips that have a law.
pub(super) fn slips_of(assembled: &Assembled, joint: usize) -> Vec<usize> {
    let slips = assembled.slips().iter().enumerate();
    slips.filter(|(_, slip)| slip.joint == joint && slip.law.is_some()).map(|(n, _)| n).collect()
}

/// Indices, among the slips that have a law, of the slips of a group.
pub(super) fn slips_of_group(assembled: &Assembled, group: &JointGroup) -> Vec<usize> {
    let with_law = assembled.slips().iter().filter(|slip| slip.law.is_some()).enumerate();
    with_law.filter(|(_, slip)| group.joints.contains(&slip.joint)).map(|(n, _)| n).collect()
}
