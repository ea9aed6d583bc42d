//! Equations: LaTeX in the book and in doc comments becomes MathML, which browsers draw without any script.
//!
//! Where an equation stands decides how it is written, so that it can be read without being drawn as well: in the book
//! `$…$` and `$$…$$`, in doc comments a code span between dollars and a code block of the language `math`, which
//! rustdoc leaves as they are.

mod book;
mod doc_comments;
mod mathml;
mod rustdoc;

pub(crate) use book::preprocess;
pub(crate) use rustdoc::document;
