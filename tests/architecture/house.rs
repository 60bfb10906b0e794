//! The modules of a crate and what imports what, read from the source files' tokens.
//!
//! Comments and strings are no tokens of their own, so nothing in them is taken for an import. Code under
//! `#[cfg(test)]` is passed over: a test may look at whatever it tests.

use std::collections::BTreeMap;
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The names that lead from a crate's root to a module: `["law", "jenkins"]`; empty for `lib.rs`.
pub(crate) type ModulePath = Vec<String>;

/// The source files of one crate.
#[derive(Default)]
pub(crate) struct House {
    files: BTreeMap<ModulePath, File>,
}

/// One module with a file of its own.
#[derive(Default)]
struct File {
    /// Modules declared in this file, in the order of their `mod` lines; those of tests are left out.
    children: Vec<String>,
    /// Names that this file hands on (`pub use`), and where each comes from.
    handed_on: Vec<(String, Mention)>,
    /// Names that this file imports, for paths that begin with one of them.
    aliases: Vec<(String, Mention)>,
    /// Every path that this file mentions.
    mentions: Vec<Mention>,
}

/// A path as written in a file.
#[derive(Clone)]
struct Mention {
    /// Inline modules around the place: `super` leads out of these first.
    inline: usize,
    path: Vec<String>,
}

/// `from` takes something that is defined in `to`.
pub(crate) struct Import {
    pub(crate) from: ModulePath,
    pub(crate) to: ModulePath,
    /// The path as written, to be found in the file.
    pub(crate) written: String,
}

impl House {
    /// Reads the crate whose `lib.rs` (or `main.rs`) stands in `source`.
    pub(crate) fn read(source: &Path) -> Self {
        let root = ["lib.rs", "main.rs"].map(|name| source.join(name));
        let root = root.iter().find(|file| file.exists()).expect("lib.rs or main.rs");
        let mut house = Self::default();
        house.enter(Vec::new(), root, source);
        house
    }

    /// A house that exists on paper only: the text of each module.
    pub(crate) fn on_paper(modules: &[(&str, &str)]) -> Self {
        let path = |name: &str| name.split("::").filter(|s| !s.is_empty()).map(str::to_owned).collect();
        Self { files: modules.iter().map(|(name, text)| (path(name), File::parse(text))).collect() }
    }

    fn enter(&mut self, module: ModulePath, file: &Path, folder: &Path) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let parsed = File::parse(&text);
        for child in parsed.children.clone() {
            let mut path = module.clone();
            path.push(child.clone());
            let alone = folder.join(format!("{child}.rs"));
            let room = folder.join(&child);
            if alone.exists() {
                self.enter(path, &alone, &room);
            } else {
                self.enter(path, &room.join("mod.rs"), &room);
            }
        }
        self.files.insert(module, parsed);
    }

    /// Number of modules with a file of their own.
    pub(crate) fn len(&self) -> usize {
        self.files.len()
    }

    /// Every import between two files of the crate.
    pub(crate) fn imports(&self) -> Vec<Import> {
        let mut imports = Vec::new();
        for (from, file) in &self.files {
            for mention in &file.mentions {
                if let Some(to) = self.resolve(from, mention, 0)
                    && to != *from
                {
                    imports.push(Import { from: from.clone(), to, written: mention.path.join("::") });
                }
            }
        }
        imports
    }

    /// The file in which what is mentioned in `module` is defined; none for other crates and local names.
    fn resolve(&self, module: &[String], mention: &Mention, depth: usize) -> Option<ModulePath> {
        assert!(depth < 20, "{} hands a name on in a circle: {:?}", module.join("::"), mention.path);
        let file = &self.files[module];
        let (first, rest) = mention.path.split_first()?;
        match first.as_str() {
            "crate" => self.walk(Vec::new(), rest, depth),
            "self" => self.walk(module.to_vec(), rest, depth),
            "super" => {
                let ups = 1 + rest.iter().take_while(|name| *name == "super").count();
                let up = ups.saturating_sub(mention.inline);
                let above = module[..module.len().checked_sub(up)?].to_vec();
                self.walk(above, &mention.path[ups..], depth)
            }
            name if file.children.iter().any(|child| child == name) => {
                self.walk(module.to_vec(), &mention.path, depth)
            }
            name => {
                let (_, alias) = file.aliases.iter().find(|(alias, _)| alias == name)?;
                let path = alias.path.iter().chain(rest).cloned().collect();
                self.resolve(module, &Mention { path, ..alias.clone() }, depth + 1)
            }
        }
    }

    fn walk(&self, mut at: ModulePath, names: &[String], depth: usize) -> Option<ModulePath> {
        for (i, name) in names.iter().enumerate() {
            let file = &self.files[&at];
            if file.children.contains(name) {
                at.push(name.clone());
            } else if let Some((_, origin)) = file.handed_on.iter().find(|(handed, _)| handed == name) {
                let path = origin.path.iter().chain(&names[i + 1..]).cloned().collect();
                return self.resolve(&at, &Mention { path, ..origin.clone() }, depth + 1);
            } else {
                return Some(at);
            }
        }
        Some(at)
    }

    /// Imports from a module that is declared below the one that imports.
    pub(crate) fn upward(&self) -> Vec<Import> {
        self.imports().into_iter().filter(|import| self.runs_upward(import)).collect()
    }

    fn runs_upward(&self, import: &Import) -> bool {
        let shared = import.from.iter().zip(&import.to).take_while(|(a, b)| a == b).count();
        let (Some(a), Some(b)) = (import.from.get(shared), import.to.get(shared)) else {
            return false; // One lies inside the other: that is a question of circles.
        };
        let order = &self.files[&import.from[..shared]].children;
        let place = |name| order.iter().position(|child| child == name);
        place(b) > place(a)
    }

    /// A circle of files that import each other, if there is one.
    pub(crate) fn circle(&self) -> Option<Vec<ModulePath>> {
        let mut arrows: BTreeMap<ModulePath, Vec<ModulePath>> = BTreeMap::new();
        for import in self.imports() {
            arrows.entry(import.from).or_default().push(import.to);
        }
        let mut left = Vec::new();
        self.files.keys().find_map(|start| follow(start, &arrows, &mut Vec::new(), &mut left))
    }
}

/// Walks along the arrows until a file is met that is already on the way. `left` are files from which no circle is reached.
fn follow(
    at: &ModulePath,
    arrows: &BTreeMap<ModulePath, Vec<ModulePath>>,
    way: &mut Vec<ModulePath>,
    left: &mut Vec<ModulePath>,
) -> Option<Vec<ModulePath>> {
    if let Some(met) = way.iter().position(|file| file == at) {
        return Some(way[met..].to_vec());
    }
    if left.contains(at) {
        return None;
    }
    way.push(at.clone());
    let found = arrows.get(at).into_iter().flatten().find_map(|next| follow(next, arrows, way, left));
    way.pop();
    left.push(at.clone());
    found
}

impl File {
    fn parse(text: &str) -> Self {
        let mut file = Self::default();
        file.scan(text.parse().expect("a source file that compiles"), 0);
        file
    }

    /// Reads items, bodies and macro calls alike: an import is a `use`, or a path that begins in the crate.
    fn scan(&mut self, tokens: TokenStream, inline: usize) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        let mut public = false;
        while at < tokens.len() {
            let passed = tests_end(&tokens, at);
            if passed > at {
                at = passed;
                continue;
            }
            match &tokens[at] {
                TokenTree::Ident(word) if *word == "pub" => public = true,
                TokenTree::Ident(word) if *word == "mod" => {
                    at += self.module(&tokens[at + 1..], inline);
                    public = false;
                }
                // `use<'_>` behind a type says what it captures and imports nothing.
                TokenTree::Ident(word)
                    if *word == "use" && !tokens.get(at + 1).is_some_and(|t| is_punct(t, '<')) =>
                {
                    let end = at + tokens[at..].iter().position(|t| is_punct(t, ';')).unwrap_or(0);
                    self.imported(&tokens[at + 1..end], &[], inline, public);
                    at = end;
                    public = false;
                }
                TokenTree::Ident(word) if path_goes_on(&tokens, at + 1) => {
                    let mut path = vec![word.to_string()];
                    while path_goes_on(&tokens, at + 1) {
                        at += 3;
                        match &tokens[at] {
                            TokenTree::Ident(name) => path.push(name.to_string()),
                            _ => break,
                        }
                    }
                    self.mentions.push(Mention { inline, path });
                }
                TokenTree::Group(group) if public && group.delimiter() == Delimiter::Parenthesis => {}
                TokenTree::Group(group) => {
                    self.scan(group.stream(), inline);
                    public = false;
                }
                _ => public = false,
            }
            at += 1;
        }
    }

    /// What follows the word `mod`: a child with a file of its own, or an inline module. Returns the tokens used.
    fn module(&mut self, tokens: &[TokenTree], inline: usize) -> usize {
        match tokens {
            [TokenTree::Ident(name), end, ..] if is_punct(end, ';') => {
                self.children.push(name.to_string());
                2
            }
            [TokenTree::Ident(_), TokenTree::Group(body), ..] => {
                self.scan(body.stream(), inline + 1);
                2
            }
            _ => 0,
        }
    }

    /// One tree of a `use`: the paths at its leaves, with the names they get here.
    fn imported(&mut self, tokens: &[TokenTree], stem: &[String], inline: usize, public: bool) {
        for branch in tokens.split(|t| is_punct(t, ',')) {
            let mut path = stem.to_vec();
            let mut name = None;
            let mut words = branch.iter();
            while let Some(token) = words.next() {
                match token {
                    TokenTree::Ident(word) if *word == "as" => name = words.next().map(ToString::to_string),
                    TokenTree::Ident(word) => path.push(word.to_string()),
                    TokenTree::Group(group) => {
                        let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                        self.imported(&inner, &path, inline, public);
                        path.clear();
                    }
                    TokenTree::Punct(_) | TokenTree::Literal(_) => {}
                }
            }
            if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
                path.pop();
            }
            let Some(last) = path.last().cloned() else { continue };
            let mention = Mention { inline, path };
            let name = name.unwrap_or(last);
            if public {
                self.handed_on.push((name.clone(), mention.clone()));
            }
            // `use fmt;` would name itself for ever.
            if mention.path.first() != Some(&name) {
                self.aliases.push((name, mention.clone()));
            }
            self.mentions.push(mention);
        }
    }
}

/// Where an item under `#[cfg(test)]` that begins at `at` has its end; `at` itself for anything else.
fn tests_end(tokens: &[TokenTree], at: usize) -> usize {
    let [hash, TokenTree::Group(attribute), ..] = &tokens[at..] else { return at };
    let text = attribute.stream().to_string().replace(' ', "");
    if !is_punct(hash, '#') || !(text == "cfg(test)" || text.starts_with("cfg(all(test")) {
        return at;
    }
    let ends = |t: &TokenTree| {
        is_punct(t, ';') || matches!(t, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace)
    };
    let item = at + 2;
    tokens[item..].iter().position(ends).map_or(tokens.len(), |end| item + end + 1)
}

fn is_punct(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// Whether `::` and one more token stand at `at`.
fn path_goes_on(tokens: &[TokenTree], at: usize) -> bool {
    matches!(&tokens[at.min(tokens.len())..], [a, b, _, ..] if is_punct(a, ':') && is_punct(b, ':'))
}
