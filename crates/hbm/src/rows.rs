//! The rows of a balance: relative displacements at contacts, each a sum of a few dofs.
//!
//! A scalar contact is one row, first − second; after those of all contacts come the directions of all joints.

use std::ops::Range;

use crate::problem::{Contact, Joint};

/// Relative displacements as functionals `Σ coefficient · dof`, hence the columns of B.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rows {
    /// (dof, coefficient) of all rows, one after the other.
    parts: Vec<(usize, f64)>,
    /// Where the parts of each row begin, and where the last ends.
    starts: Vec<usize>,
}

impl Rows {
    /// The rows of `contacts`, then those of `joints`.
    pub(crate) fn new(contacts: &[Contact], joints: &[Joint]) -> Self {
        let mut rows = Self { parts: Vec::new(), starts: vec![0] };
        for contact in contacts {
            rows.push([(contact.first, 1.0)].into_iter().chain(contact.second.map(|second| (second, -1.0))));
        }
        for direction in joints.iter().flat_map(|joint| &joint.directions) {
            rows.push(direction.parts.iter().copied());
        }
        rows
    }

    /// Rows of these parts.
    #[cfg(test)]
    pub(crate) fn of(rows: &[&[(usize, f64)]]) -> Self {
        let mut all = Self { parts: Vec::new(), starts: vec![0] };
        for row in rows {
            all.push(row.iter().copied());
        }
        all
    }

    fn push(&mut self, parts: impl Iterator<Item = (usize, f64)>) {
        self.parts.extend(parts);
        self.starts.push(self.parts.len());
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// (dof, coefficient) of one row.
    #[inline]
    pub(crate) fn parts(&self, row: usize) -> &[(usize, f64)] {
        &self.parts[self.starts[row]..self.starts[row + 1]]
    }

    /// The parts of every row, in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[(usize, f64)]> + Clone {
        (0..self.count()).map(|row| self.parts(row))
    }

    /// Every dof that a row has a part of, again for every row.
    pub(crate) fn dofs(&self) -> impl Iterator<Item = usize> + '_ {
        self.parts.iter().map(|&(dof, _)| dof)
    }
}

/// The rows of each joint among all rows, `contacts` rows being those of scalar contacts.
pub(crate) fn joint_rows(contacts: usize, joints: &[Joint]) -> impl Iterator<Item = (&Joint, Range<usize>)> {
    joints.iter().scan(contacts, |end, joint| {
        let start = *end;
        *end += joint.directions.len();
        Some((joint, start..*end))
    })
}
