function unit = unit_of(document, name)
% Of 'M', 'B', 'K', 'x0' or 'force'; '' where the document does not say what moves.
  unit = '';
  if isfield(document, 'units')
    unit = document.units.(name);
  end
end
