//! A named array as a file stores it.

/// A named array of one or two dimensions, stored column after column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) values: Vec<f64>,
}

impl Variable {
    /// An array of one column.
    pub(crate) fn vector(name: String, unit: String, values: Vec<f64>) -> Self {
        Self { name, unit, rows: values.len(), columns: 1, values }
    }

    pub(super) fn is_vector(&self) -> bool {
        (self.rows == 1 || self.columns == 1) && self.values.len() > 1
    }

    /// The channels in an array, one vector each: samples run along the dimension that is `length` long, else along the longer one.
    pub(super) fn split(self, length: Option<usize>) -> Vec<Variable> {
        if self.rows <= 1 || self.columns <= 1 || self.values.is_empty() {
            return vec![self];
        }
        let along_columns = match length {
            Some(n) if n == self.rows => true,
            Some(n) if n == self.columns => false,
            _ => self.rows >= self.columns,
        };
        let count = if along_columns { self.columns } else { self.rows };
        (0..count).map(|k| self.slice(k, along_columns)).collect()
    }

    fn slice(&self, k: usize, along_columns: bool) -> Variable {
        let name = format!("{}[{k}]", self.name);
        let values = if along_columns {
            self.values[k * self.rows..(k + 1) * self.rows].to_vec()
        } else {
            self.values.iter().skip(k).step_by(self.rows).copied().collect()
        };
        Variable::vector(name, self.unit.clone(), values)
    }
}
