function cells = items(list)
% The parts of a list, whether it was decoded as a struct array or as a cell.
  if isempty(list)
    cells = {};
  elseif iscell(list)
    cells = list(:)';
  else
    cells = num2cell(list(:)');
  end
end
