//! A matrix of a model: written row by row, or in a file.

use faer::Mat;
use faer::sparse::SparseColMat;
use structure::MatrixFile;

use crate::error::SceneError;
use crate::read::Node;
use crate::records::Records;

pub(crate) const MATRIX_MARKET_KEYS: [&str; 1] = ["matrix_market"];
pub(crate) const NPY_KEYS: [&str; 1] = ["npy"];
pub(crate) const NPZ_KEYS: [&str; 2] = ["npz", "entry"];

/// Keys of an object that stands for a matrix.
const FILES: [&str; 3] = ["matrix_market", "npy", "npz"];

const FORM: &str = "rows of numbers, {\"matrix_market\": \"K.mtx\"}, {\"npy\": \"K.npy\"} or {\"npz\": \"K.npz\", \"entry\": \"K\"}";

/// A square matrix as it was given.
#[derive(Debug, Clone)]
pub(crate) enum Matrix {
    Dense(Mat<f64>),
    Sparse(SparseColMat<usize, f64>),
}

impl Matrix {
    /// Number of rows and columns.
    pub(crate) fn size(&self) -> usize {
        match self {
            Self::Dense(matrix) => matrix.nrows(),
            Self::Sparse(matrix) => matrix.nrows(),
        }
    }

    pub(crate) fn is_dense(&self) -> bool {
        matches!(self, Self::Dense(_))
    }

    pub(crate) fn sparse(self) -> SparseColMat<usize, f64> {
        match self {
            Self::Dense(matrix) => structure::compressed(&matrix),
            Self::Sparse(matrix) => matrix,
        }
    }
}

/// Whether `node` names a file with a matrix.
pub(crate) fn is_file(node: &Node) -> bool {
    FILES.iter().any(|key| node.peek(key).is_some())
}

/// Reads a matrix with a row for each of the `dofs`, where their number is known. What was noticed in a file goes to
/// `notes`.
pub(crate) fn read(
    node: &Node,
    dofs: Option<usize>,
    records: &Records,
    notes: &mut Vec<String>,
) -> Result<Matrix, SceneError> {
    if !node.is_object() {
        return if node.is_list() { rows(node, dofs).map(Matrix::Dense) } else { Err(node.must_be(FORM)) };
    }
    let (file, read) = read_file(node, records)?;
    let name = file.text("the name of a file")?;
    let read = read.map_err(|problem| file.error(format!("{name}: {problem}")))?;
    let size = read.matrix.nrows();
    if let Some(n) = dofs.filter(|n| *n != size) {
        return Err(file.error(format!("{name} is {size} x {size}, but model.dofs has {n} names")));
    }
    notes.extend(read.notes.iter().map(|note| format!("{}: {name}: {note}", node.path())));
    Ok(Matrix::Sparse(read.matrix))
}

type FileAndMatrix<'a> = (Node<'a>, Result<MatrixFile, structure::MatrixFileError>);

fn read_file<'a>(node: &Node<'a>, records: &Records) -> Result<FileAndMatrix<'a>, SceneError> {
    let path = |file: &Node| Ok::<_, SceneError>(records.file(file.text("the name of a file")?));
    if node.peek("npz").is_some() {
        let npz = node.object(FORM, &NPZ_KEYS)?;
        let file = npz.need("npz", "\"K.npz\"")?;
        let entry =
            npz.get("entry").map(|entry| entry.text("the name of an array in the file")).transpose()?;
        let matrix = structure::read_npz(&path(&file)?, entry);
        return Ok((file, matrix));
    }
    if node.peek("npy").is_some() {
        let file = node.object(FORM, &NPY_KEYS)?.need("npy", "\"K.npy\"")?;
        let matrix = structure::read_npy(&path(&file)?);
        return Ok((file, matrix));
    }
    let file = node.object(FORM, &MATRIX_MARKET_KEYS)?.need("matrix_market", "\"K.mtx\"")?;
    let matrix = structure::read_matrix_market(&path(&file)?);
    Ok((file, matrix))
}

/// A dense matrix, row by row.
fn rows(node: &Node, dofs: Option<usize>) -> Result<Mat<f64>, SceneError> {
    let rows = node.list("of rows")?;
    let n = dofs.unwrap_or(rows.len());
    if rows.len() != n {
        return Err(node.error(format!("must have {n} rows, one a dof in model.dofs, got {}", rows.len())));
    }
    let mut matrix = Mat::zeros(n, n);
    for (i, row) in rows.iter().enumerate() {
        let numbers = row.numbers("of numbers")?;
        if numbers.len() != n {
            return Err(row.error(format!("must have {n} numbers, one a dof, got {}", numbers.len())));
        }
        for (j, number) in numbers.into_iter().enumerate() {
            matrix[(i, j)] = number;
        }
    }
    Ok(matrix)
}
