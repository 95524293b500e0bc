//! Why a table is not the reference of a scene or layout.

/// What is wrong with a table that comes with the program.
#[derive(Debug, thiserror::Error)]
pub enum BadTable {
    /// It is no table.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A cell of a column.
    #[error("column {column}: '{cell}' is not a number")]
    CellOfColumn {
        /// Name of the column.
        column: String,
        /// What stands there.
        cell: String,
    },
    /// A cell.
    #[error("'{0}' is not a number")]
    Cell(String),
    /// It says nothing.
    #[error("the table has no rows")]
    NoRows,
    /// A column is not there.
    #[error("the table has no column {0}")]
    NoColumn(String),
    /// The name of a column does not say what is in it.
    #[error("column {column} names no {what}")]
    Unnamed {
        /// The name.
        column: String,
        /// What it should name.
        what: &'static str,
    },
    /// A row has too many cells, or too few.
    #[error("a row of '{table}' has not {width} cells")]
    Width {
        /// Name of the table.
        table: String,
        /// How many there should be.
        width: usize,
    },
    /// A row leaves out what it must have.
    #[error("a row of '{table}' has no column {column}")]
    EmptyCell {
        /// Name of the table.
        table: String,
        /// Number of the column, from zero.
        column: usize,
    },
    /// No gap has this name.
    #[error("'{0}' is no gap")]
    NoGap(String),
    /// When the gap closes is left out.
    #[error("a gap has no day")]
    NoDay,
}

/// Why a table is not the reference of a scene or layout.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// It is about another problem.
    #[error("the table '{table}' is about another problem: {}", differences.join("; "))]
    Another {
        /// Name of the table.
        table: String,
        /// What differs, in words.
        differences: Vec<String>,
    },
    /// There is none of this name.
    #[error("there is no reference table '{name}'; the tables are {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// Names of those that there are.
        known: Vec<&'static str>,
    },
    /// There is none of this name that layouts are compared with.
    #[error("there is no table '{name}' of a layout; the tables are {}", known.join(", "))]
    UnknownLayout {
        /// The name.
        name: String,
        /// Names of those that there are.
        known: Vec<&'static str>,
    },
    /// The name says neither rings nor soil.
    #[error("the name of the table '{0}' tells no layout")]
    NoLayout(String),
    /// It cannot be read.
    #[error(transparent)]
    Bad(#[from] BadTable),
}

impl Unfit {
    /// A table about another problem.
    pub(crate) fn another(table: &str, differences: Vec<String>) -> Unfit {
        Unfit::Another { table: table.into(), differences }
    }

    /// Nothing, if nothing differs.
    pub(crate) fn unless_same(table: &str, differences: Vec<String>) -> Result<(), Unfit> {
        if differences.is_empty() { Ok(()) } else { Err(Unfit::another(table, differences)) }
    }
}
