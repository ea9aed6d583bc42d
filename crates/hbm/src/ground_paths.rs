//! Chains of contacts from a dof to the ground.

use crate::problem::Problem;

/// The shortest chain of contacts from every output dof to the ground, where there is one.
pub(crate) fn paths_to_ground<M>(problem: &Problem<M>, dofs: usize) -> Vec<Option<Vec<(usize, f64)>>> {
    // The contact by which a dof was reached first, and the dof before it on the way from the ground.
    let mut reached: Vec<Option<(usize, f64, Option<usize>)>> = vec![None; dofs];
    let mut beside: Vec<Vec<(usize, f64, usize)>> = vec![Vec::new(); dofs];
    let mut front = Vec::new();
    for (c, contact) in problem.contacts.iter().enumerate() {
        match contact.second {
            None if reached[contact.first].is_none() => {
                reached[contact.first] = Some((c, 1.0, None));
                front.push(contact.first);
            }
            None => {}
            Some(second) => {
                beside[second].push((c, 1.0, contact.first));
                beside[contact.first].push((c, -1.0, second));
            }
        }
    }
    while !front.is_empty() {
        // Of several contacts that reach a dof after as many steps the first one counts.
        let mut next: Vec<(usize, f64, usize, usize)> = front
            .iter()
            .flat_map(|&from| beside[from].iter().map(move |&(c, sign, to)| (c, sign, from, to)))
            .filter(|&(.., to)| reached[to].is_none())
            .collect();
        next.sort_by_key(|&(c, ..)| c);
        front.clear();
        for (c, sign, from, to) in next {
            if reached[to].is_none() {
                reached[to] = Some((c, sign, Some(from)));
                front.push(to);
            }
        }
    }
    let path = |&output: &usize| {
        let mut path = Vec::new();
        let mut dof = output;
        loop {
            let (c, sign, before) = reached[dof]?;
            path.push((c, sign));
            match before {
                Some(before) => dof = before,
                None => break,
            }
        }
        // From the ground on.
        path.reverse();
        Some(path)
    };
    problem.output.iter().map(path).collect()
}
