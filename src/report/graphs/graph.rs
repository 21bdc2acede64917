//! A graph with attributes, as a value.

/// What an attribute says.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A count, or an index.
    Whole(u64),
    /// A measure.
    Number(f64),
    /// A word.
    Text(String),
    /// Whether something is so.
    Truth(bool),
}

/// The attributes of a vertex or of an edge, each with its name. Attributes of one name are of one type in all of a graph.
pub type Attributes = Vec<(String, Value)>;

/// A vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Vertex {
    /// Its name, which no other has: a word without spaces.
    pub id: String,
    /// What is known of it.
    pub attributes: Attributes,
}

/// An edge, which leads from one vertex to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The place of the vertex that it comes from.
    pub from: usize,
    /// The place of the one that it leads to.
    pub to: usize,
    /// What is known of it.
    pub attributes: Attributes,
}

/// A directed graph. There may be several edges from one vertex to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Its name: `G_r`, `G_v` or `G_p`.
    pub name: &'static str,
    /// Its vertices.
    pub vertices: Vec<Vertex>,
    /// Its edges.
    pub edges: Vec<Edge>,
}

impl Graph {
    /// One without a vertex.
    pub fn new(name: &'static str) -> Graph {
        Graph { name, vertices: Vec::new(), edges: Vec::new() }
    }

    /// Adds a vertex, and tells its place.
    pub fn add_vertex(&mut self, id: String, attributes: Attributes) -> usize {
        self.vertices.push(Vertex { id, attributes });
        self.vertices.len() - 1
    }

    /// Adds an edge between vertices, by their places.
    pub fn add_edge(&mut self, from: usize, to: usize, attributes: Attributes) {
        self.edges.push(Edge { from, to, attributes });
    }

    /// The sum of a count over all vertices that have it.
    pub fn vertex_sum(&self, name: &str) -> u64 {
        self.vertices.iter().map(|vertex| whole_of(&vertex.attributes, name)).sum()
    }

    /// The same over all edges.
    pub fn edge_sum(&self, name: &str) -> u64 {
        self.edges.iter().map(|edge| whole_of(&edge.attributes, name)).sum()
    }
}

impl Edge {
    /// What an attribute that is a word says.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find_map(|(known, value)| match value {
            Value::Text(text) if known == name => Some(text.as_str()),
            _ => None,
        })
    }
}

fn whole_of(attributes: &Attributes, name: &str) -> u64 {
    let counts = attributes.iter().filter(|(known, _)| known == name);
    counts.map(|(_, value)| if let Value::Whole(count) = value { *count } else { 0 }).sum()
}

/// A count as an attribute.
pub fn whole(name: impl Into<String>, count: u64) -> (String, Value) {
    (name.into(), Value::Whole(count))
}

/// A measure as an attribute. What is infinite is told as the largest number, as not all readers know infinity.
pub fn number(name: impl Into<String>, measure: f64) -> (String, Value) {
    (name.into(), Value::Number(measure.clamp(f64::MIN, f64::MAX)))
}

/// A word as an attribute.
pub fn text(name: impl Into<String>, text: impl Into<String>) -> (String, Value) {
    (name.into(), Value::Text(text.into()))
}
