//! The catalogue of errors: every kind that a user can meet, with a permanent name, its cause and what helps.

/// Defines all kinds in one list: variant, name, exit code of the command line, cause, remedy.
macro_rules! kinds {
    ($($variant:ident, $name:literal, $code:literal, $cause:literal, $remedy:literal;)*) => {
        /// A kind of error. Names stay from release to release; programs may rely on them.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Kind {
            $(#[doc = $cause] $variant,)*
        }

        impl Kind {
            /// All kinds, in the order of the catalogue.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Its name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Exit code of the command line.
            #[must_use]
            pub const fn exit_code(self) -> u8 {
                match self { $(Self::$variant => $code,)* }
            }

            /// What causes it.
            #[must_use]
            pub const fn cause(self) -> &'static str {
                match self { $(Self::$variant => $cause,)* }
            }

            /// What helps.
            #[must_use]
            pub const fn remedy(self) -> &'static str {
                match self { $(Self::$variant => $remedy,)* }
            }
        }
    };
}

kinds! {
    Usage, "usage", 2, "An option or argument that the command does not know, or that is missing or malformed.",
        "see `iwan COMMAND --help`";
    Input, "input", 2, "An input file or a combination of options that says something that cannot be computed.",
        "change the place that the message names";
    Value, "value", 2, "A number outside the range in which the models hold, or a list of the wrong length.",
        "give a value in the range that the message states; check units";
    Unreadable, "unreadable", 2, "A file that the operating system does not give: missing, forbidden, a folder, a device, a pipe without a writer.",
        "check path and permissions";
    UnknownFormat, "unknown-format", 2, "A file in no known format.", "export it to one of the formats that the message lists";
    Unsupported, "unsupported", 2, "A known format in a variant that is not read.", "export it in the way the message says";
    Damaged, "damaged", 2, "Bytes that break the rules of their format.", "export the file again, or repair the place that is named";
    CutShort, "cut-short", 2, "A file that ends long before what its header promises.", "copy or export it again";
    NoTime, "no-time", 2, "A record without times or sampling rate.", "give --rate, or name the time with --time";
    UnknownName, "unknown-name", 2, "A channel, column or time vector that the file does not hold.", "choose one of the names that are listed";
    Ambiguous, "ambiguous", 2, "A file that does not tell which channels are meant, or that has none.", "choose with --channel or --quantity";
    Mismatch, "mismatch", 2, "Channels that differ in length or sampling.", "choose channels that belong together";
    TimeOrder, "time-order", 2, "Times that run backwards.", "sort or cut the record, or give --rate";
    TimeRepeated, "time-repeated", 2, "A clock that stutters: one time at several samples.", "give --rate, or interpolate with --resample";
    TimeUneven, "time-uneven", 2, "Times that increase unevenly.", "resample with --resample, or give --rate";
    TimeUnit, "time-unit", 2, "Times in what is no unit of time.", "name the unit with --time-unit";
    SeveralTimes, "several-times", 2, "Time vectors of different records in one file.", "choose one with --time";
    Unit, "unit", 2, "A channel whose unit cannot be converted.", "leave --unit out, or convert the file";
    NotFinite, "not-finite", 2, "A sample that is NaN or infinite, more of them than can be passed over.", "cut the record there, or repair it";
    TooShort, "too-short", 2, "Fewer samples, cycles or values than the method needs.", "record longer, or choose another method";
    Stretch, "stretch", 2, "A stretch of time in which the record has no samples.", "choose --from and --to inside the record";
    Refused, "refused", 2, "Measurements that show something which must not be smoothed over, or that do not belong together.",
        "see the message: each has a remedy of its own";
    Structure, "structure", 2, "An element, node, joint, tie or load of a structure that cannot work.", "repair what is named";
    MissingSet, "missing-set", 2, "A node or element set that does not exist.", "choose one of the sets that are listed";
    MissingMode, "missing-mode", 2, "A mode that does not exist under this name.", "choose one of the modes that are listed";
    Exists, "exists", 2, "Results that are there already.", "choose another folder with --out, or overwrite with --force";
    Checkpoint, "checkpoint", 2, "A checkpoint of other work, or a folder that is none.", "repeat the command that began it, or give another folder";
    Unwritable, "unwritable", 1, "A file or folder that cannot be written: forbidden, or the disk is full. Where that is seen before the computation begins, the \
         exit code is 2.", "check permissions and space, or choose another folder";
    Busy, "busy", 1, "Another process that writes into the same folder. Where that is seen before the computation begins, the exit code is 2.",
        "wait for it, or choose another folder";
    Memory, "memory", 1, "More memory is needed than there is, or than --memory allows. Where an input file asks for it, the exit code is 2.",
        "see the message: shorter, coarser, fewer";
    Analysis, "analysis", 1, "An analysis that the structure does not admit, or that failed its own check.", "see the message";
    Overflow, "overflow", 1, "Numbers that overflow in time.", "check units and amplitude, shorten the time step";
    NoStiffness, "no-stiffness", 1, "A softening spring has taken all stiffness from a mode.", "lower the amplitude, or the spring's coefficient";
    BeyondCurves, "beyond-curves", 1, "A motion beyond the largest amplitude of measured curves.", "measure there, lower the force, or allow extrapolation";
    Failed, "failed", 1, "A computation that failed otherwise.", "see the message";
    Strict, "strict", 1, "With --strict: a warning about the results, which are written all the same.", "look at the warning";
    Fault, "fault", 1, "A fault of this program.", "report it, with the input";
    Interrupted, "interrupted", 130, "Ctrl-C, or a request to end.", "run it again; with --checkpoint it goes on";
}
