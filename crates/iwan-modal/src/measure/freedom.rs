//! A point of the structure, and the direction in which a force acts or a motion is measured there.

use std::fmt;

/// Direction of a force or motion at a point, with the codes of the universal file format: 0 none, 1 to 3 along x, y, z,
/// 4 to 6 about them, negative against them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Direction(i8);

impl Direction {
    /// From the code -6 to 6; none for other codes.
    ///
    /// ```
    /// use iwan_modal::measure::Direction;
    /// assert_eq!(Direction::from_code(-3).map(|d| d.to_string()), Some("-z".into()));
    /// assert_eq!(Direction::from_code(7), None);
    /// ```
    #[must_use]
    pub fn from_code(code: i64) -> Option<Self> {
        i8::try_from(code).ok().filter(|c| (-6..=6).contains(c)).map(Self)
    }

    /// From `+x`, `-z`, `y`, `+rx`, or nothing.
    ///
    /// ```
    /// use iwan_modal::measure::Direction;
    /// assert_eq!(Direction::from_name("z"), Direction::from_code(3));
    /// assert_eq!(Direction::from_name("-rx"), Direction::from_code(-4));
    /// assert_eq!(Direction::from_name("up"), None);
    /// ```
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let lower = name.trim().to_lowercase();
        let (sign, axis) = match lower.strip_prefix('-') {
            Some(axis) => (-1, axis),
            None => (1, lower.strip_prefix('+').unwrap_or(&lower)),
        };
        let code = match axis {
            "" => 0,
            "x" => 1,
            "y" => 2,
            "z" => 3,
            "rx" => 4,
            "ry" => 5,
            "rz" => 6,
            _ => return None,
        };
        Some(Self(sign * code))
    }

    /// The code, -6 to 6.
    #[must_use]
    pub fn code(self) -> i8 {
        self.0
    }

    /// +1 along the axis, -1 against it.
    #[must_use]
    pub fn sign(self) -> f64 {
        if self.0 < 0 { -1.0 } else { 1.0 }
    }

    /// The positive direction of the same axis.
    #[must_use]
    pub fn axis(self) -> Self {
        Self(self.0.abs())
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const AXES: [&str; 7] = ["", "x", "y", "z", "rx", "ry", "rz"];
        let sign = match self.0 {
            0 => "",
            1.. => "+",
            _ => "-",
        };
        write!(f, "{sign}{}", AXES[usize::from(self.0.unsigned_abs())])
    }
}

/// A point with a direction: a degree of freedom of the measurement.
///
/// ```
/// use iwan_modal::measure::Freedom;
/// let tip = Freedom::parse("54:-z").expect("a point and a direction");
/// assert_eq!((tip.point.as_str(), tip.to_string().as_str()), ("54", "54:-z"));
/// assert!(tip.is_at(&Freedom::parse("54:+z").unwrap()));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Freedom {
    /// Name or node number of the point.
    pub point: String,
    /// Direction there.
    pub direction: Direction,
}

impl Freedom {
    /// A point for which no direction is given.
    #[must_use]
    pub fn point(point: impl Into<String>) -> Self {
        Self { point: point.into(), direction: Direction::default() }
    }

    /// From `POINT` or `POINT:DIRECTION`; none where the direction is not known.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        match text.rsplit_once(':') {
            None => Some(Self::point(text.trim())),
            Some((point, direction)) => {
                Some(Self { point: point.trim().into(), direction: Direction::from_name(direction)? })
            }
        }
    }

    /// Whether both are at the same point along the same axis, in the same or the opposite sense.
    #[must_use]
    pub fn is_at(&self, other: &Self) -> bool {
        self.point == other.point && self.direction.axis() == other.direction.axis()
    }
}

impl fmt::Display for Freedom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.direction.code() == 0 {
            f.write_str(&self.point)
        } else {
            write!(f, "{}:{}", self.point, self.direction)
        }
    }
}
